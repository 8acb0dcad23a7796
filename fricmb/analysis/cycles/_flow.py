"""The flow of a scene: where a stretch of motion ends, and the derivatives of that."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb._simulate import simulate
from fricmb.analysis._errors import AnalysisError, Floats, checked_scene

if TYPE_CHECKING:
    from fricmb.scene import Scene
    from fricmb.solution import Names, Solution


@dataclass(frozen=True, kw_only=True)
class Arc:
    """A stretch of motion with its derivatives; states y = (q, v, z).

    Attributes
    ----------
    solution : Solution
    end : (n_y,)
        State at the end.
    by_state : (n_y, n_y)
        Derivative of the end by the start, at fixed time.
    by : dict of str to (n_y,)
        Derivative of the end by parameters, at fixed time and start.
    """

    solution: Solution
    end: Floats
    by_state: Floats
    by: Mapping[str, Floats] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Flow:
    """How stretches of motion of a scene are run: ``options`` are those of :func:`fricmb.simulate`."""

    scene: Scene
    options: Mapping[str, Any]

    def with_values(self, values: Mapping[str, float]) -> Flow:
        """The same with other values of parameters."""
        return Flow(scene=self.scene.with_parameters(dict(values)), options=self.options)

    def run(self, y: Floats, t_start: float, t_end: float, names: Names, **more: Any) -> Solution:
        """The motion alone."""
        options = {**self.options, **more}
        return simulate(self.scene, t_start=t_start, t_end=t_end, initial=as_initial(y, names), **options)

    def arc(self, y: Floats, t_start: float, t_end: float, names: Names, by: Sequence[str] = ()) -> Arc:
        """The motion with the derivatives of its end by its start and by parameters."""
        sol = self.run(y, t_start, t_end, names, sensitivities=("state", *by))
        held = sol.derivatives
        return Arc(
            solution=sol,
            end=end_state(sol),
            by_state=sol.monodromy,
            by={name: held.end[:, held.column(name)] for name in by},
        )


def as_initial(y: Floats, names: Names) -> dict[str, dict[str, Any]]:
    """A state as what ``simulate(initial=)`` takes."""
    n = len(names.dofs)
    z = y[2 * n :]
    starts = names.z_start
    held = {
        contact: z[starts[k] : starts[k + 1]] for k, contact in enumerate(names.contacts) if starts[k + 1] > starts[k]
    }
    return {
        "position": dict(zip(names.dofs, y[:n].tolist(), strict=True)),
        "velocity": dict(zip(names.dofs, y[n : 2 * n].tolist(), strict=True)),
        "state": held,
    }


def end_state(sol: Solution) -> Floats:
    """(q, v, z) at the end of a run."""
    return np.concatenate([sol.end.q, sol.end.v, sol.end.z])


def states_at(sol: Solution, t: Floats) -> Floats:
    """(q, v, z) at times of a run (n_y, n_t)."""
    samples = sol.at(t).record.samples
    return np.concatenate([samples.q, samples.v, samples.z])


def initial_slots(scene: Scene) -> dict[str, Any]:
    """Initial values of bodies with degrees of freedom, by their names as parameters."""
    owners = {name.partition(".")[0] for name in scene.dof_names}
    return {
        f"{part.name}.{path}": value
        for part in scene.parts
        if part.name in owners
        for path, value in part.slots().items()
        if path.startswith(("position.", "velocity."))
    }


def detached(scene: Scene) -> Scene:
    """The scene with initial values that are numbers: a parameter that stands in one has no part in a cycle."""
    from fricmb.values import parameters_in, value_of

    named = {name: value_of(value) for name, value in initial_slots(scene).items() if list(parameters_in(value))}
    return scene.with_parameters(named) if named else scene


def check_scene(scene: Scene, who: str) -> None:
    """Refuse scenes whose states are not free to be varied one by one, as surfaces that are left at once leave them."""
    from fricmb.scene import Joint, RigidBody, SpaceBody

    checked_scene(who, scene)
    turn = [part.name for part in scene.parts if isinstance(part, RigidBody | SpaceBody)]
    held = [part.name for part in scene.parts if isinstance(part, Joint) and not part.is_rigid]
    if scene.is_mechanism and (turn or held):
        listed = ", ".join(map(repr, turn + held))
        raise AnalysisError(f"{who}: does not take scenes with joints or bodies that turn; here {listed}")
