"""Whether an integrator keeps what runs rely on, and is as accurate as it says, on scenes that have closed forms."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from math import atan2, ceil, cos, exp, hypot, pi, sin, sqrt
from typing import Any

import numpy as np

from fricmb._calls import answers
from fricmb.errors import FricmbError, shown
from fricmb.integrate import Integrator
from fricmb.laws import Coulomb
from fricmb.scene import Body, Contact, Damper, Driven, Force, Scene, Spring, t
from fricmb.solution import Solution
from fricmb.testing._base import ConformanceError, findings, pickles
from fricmb.testing._model_run import Trip, run_findings

PARTS = {"linear", "ports", "nonlinear", "constraints"}


@dataclass(frozen=True, kw_only=True)
class _Case:
    """A scene, how long it is run, places at the end, and times of transitions, all in closed form."""

    scene: Scene
    t_end: float
    places: dict[str, float]
    transitions: tuple[float, ...] = ()


@answers
def check_integrator(
    integrator: Integrator, *, rtol: float = 1e-6, step: float | None = None, bound: float | None = None
) -> None:
    """Try the rules that ``simulate`` relies on, and the accuracy of runs that have a closed form.

    Parameters
    ----------
    integrator : Integrator
        Configured, as it is given to ``simulate(method=...)``.
    rtol : float
        Of the runs.
    step : float, optional
        Of an integrator that is not adaptive.
    bound : float, optional
        Greatest error of places at the end and of times of transitions, relative to the largest of each; default: a
        thousand times ``rtol``.  With fixed steps say what is to be expected of them.

    Raises
    ------
    ConformanceError
        Naming each broken rule with the numbers that show it.

    Notes
    -----
    The class names itself, its order and the parts of a problem that it takes; its options are the fields of a frozen
    dataclass, and it pickles.  A damped oscillator, a block that a rising load breaks away, an oscillator that swings
    out under dry friction, a puck on a belt in two directions: each that it takes must end where and when the closed
    form says, be finite, keep the energy ledger, repeat to the last digit, go on from its middle, come back from a
    file, and give at asked times what its dense output gives.  What it does not take it refuses by its name.

    Examples
    --------
    >>> import fricmb as fm
    >>> from fricmb.integrate import integrators
    >>> fm.testing.check_integrator(integrators["radau"](stages=5))
    """
    if not isinstance(integrator, Integrator):
        raise ConformanceError(
            "check_integrator takes an instance of fricmb.integrate.Integrator,"
            f" got {shown(integrator)}"
        )
    most = 1e3 * rtol if bound is None else bound
    name = str(getattr(integrator, "name", type(integrator).__name__))
    findings(name, [_declared, pickles], integrator)
    taken = [case for case in _cases() if _takes(integrator, case.scene)]
    trip = Trip(t_end=0.0, method=integrator, rtol=rtol, bound=most, step=step)
    rules = [_tried(case, trip) for case in taken]
    findings(name, rules or [lambda: iter(["takes none of the scenes that it is tried with"])])


def _declared(integrator: Integrator) -> Iterator[str]:
    """What the class says of itself."""
    kind: Any = type(integrator)
    for field in ("name", "order"):
        if not isinstance(getattr(kind, field, None), str) or not getattr(kind, field):
            yield f"{field} must be a string that is not empty, got {getattr(kind, field, None)!r}"
    takes = getattr(kind, "takes", None)
    if not isinstance(takes, frozenset) or not takes or not takes <= PARTS:
        yield f"takes must be a frozenset of {', '.join(sorted(PARTS))}, got {shown(takes)}"
    how = getattr(kind, "__dataclass_params__", None)
    if how is None or not how.frozen:
        yield "must be a frozen dataclass: its fields are its options"
    elif any(field.default is field.default_factory for field in fields(kind)):
        yield "each of its options must have a default"


def _takes(integrator: Integrator, scene: Scene) -> bool:
    """Whether it takes a scene.

    Raises
    ------
    ConformanceError
        If a refusal does not name the integrator.
    """
    from fricmb.system import build

    why = integrator.refuses(build(scene).problem)
    if why is not None and integrator.name not in why:
        raise ConformanceError(f"{integrator.name}: a refusal must name the integrator, got {shown(why)}")
    return why is None


def _tried(case: _Case, trip: Trip) -> Callable[[], Iterator[str]]:
    """All that is wrong with the runs of a case."""
    here = Trip(t_end=case.t_end, method=trip.method, rtol=trip.rtol, bound=trip.bound, step=trip.step)

    def rule() -> Iterator[str]:
        for finding in (*run_findings(case.scene, here), *_right(case, here)):
            yield f"{case.scene.name}: {finding}"

    return rule


def _right(case: _Case, trip: Trip) -> Iterator[str]:
    """Places, transitions and dense output."""
    try:
        sol = trip.go(case.scene, case.t_end)
        asked = trip.go(case.scene, case.t_end, t_eval=np.linspace(0.0, case.t_end, 17))
    except FricmbError:
        return  # said by the rules of the run
    scale = float(np.abs(sol.q).max()) or 1.0
    for name, place in case.places.items():
        error = abs(float(sol[name][-1]) - place)
        if not error <= trip.bound * scale:
            yield f"{name} ends at {float(sol[name][-1]):.9g}, the closed form at {place:.9g}"
    times = tuple(float(event.t) for event in sol.events)
    if len(times) != len(case.transitions):
        yield f"{len(times)} transitions, the closed form has {len(case.transitions)}"
    elif case.transitions and not np.abs(np.subtract(times, case.transitions)).max() <= trip.bound * case.t_end:
        yield f"transitions at {times}, the closed form has them at {case.transitions}"
    yield from _dense(sol, asked, scale)


def _dense(sol: Solution, asked: Solution, scale: float) -> Iterator[str]:
    if not np.array_equal(asked.t, np.linspace(0.0, sol.t_end, 17)):
        yield "a run with t_eval does not give the times of t_eval"
        return
    gap = float(np.abs(asked.q - sol(asked.t)[: len(asked.q)]).max())
    if not gap <= 1e-9 * scale:
        yield f"at the times of t_eval positions differ from the dense output by {gap:.2e}"


def _cases() -> list[_Case]:
    return [_damped(), _broken_away(), _swinging_out(), _thrown()]


def _damped() -> _Case:
    """``x = exp(-d t) (cos w t + d/w sin w t)``."""
    mass = Body("mass", mass=1.0, position={"x": 1.0})
    parts = [mass, Spring("spring", mass, axis="x", stiffness=4.0), Damper("damper", mass, axis="x", damping=0.4)]
    d, w, end = 0.2, sqrt(4.0 - 0.04), 5.0
    place = exp(-d * end) * (cos(w * end) + d / w * sin(w * end))
    return _Case(scene=Scene("damped oscillator", parts), t_end=end, places={"mass.x": place})


def _broken_away() -> _Case:
    """A load ``t`` on a block with mu_s N = 1, mu_k N = 0.5: slip from t = 1 on, ``x = s^2/4 + s^3/6`` after s."""
    block = Body("block", mass=1.0)
    law = Coulomb(mu_s=0.5, mu_k=0.25)
    parts = [block, Force("load", block, axis="x", value=t), Contact("sole", block, law=law, normal_force=2.0)]
    place = 0.25 * 1.5**2 + 1.5**3 / 6
    return _Case(scene=Scene("break-away", parts), t_end=2.5, places={"block.x": place}, transitions=(1.0,))


def _swinging_out() -> _Case:
    """Half swings of pi, each shorter by twice the friction; it stays where the spring no longer moves it."""
    friction, start = 0.15, 1.0
    mass = Body("mass", mass=1.0, position={"x": start})
    sole = Contact("sole", mass, law=Coulomb(mu_s=1.0), normal_force=friction)
    halves = ceil((start / friction - 1.0) / 2.0)
    place = (-1.0) ** halves * (start - 2.0 * halves * friction)
    scene = Scene("swings", [mass, Spring("spring", mass, axis="x", stiffness=1.0), sole])
    turns = tuple(pi * (k + 1) for k in range(halves))
    return _Case(scene=scene, t_end=pi * halves + 2.0, places={"mass.x": place}, transitions=turns)


def _thrown() -> _Case:
    """A puck across a belt: seen from the belt a straight line, at rest after ``|V|/(mu g)``."""
    belt, speed, a = 1.0, 1.5, 2.0
    puck = Body("puck", mass=1.0, axes="xy", velocity={"x": 0.0, "y": speed})
    moving = Driven("belt", velocity={"x": belt})
    sole = Contact("sole", puck, moving, law=Coulomb(mu_s=0.4), normal_force=a / 0.4)
    rest = hypot(belt, speed) / a
    way, angle, end = 0.5 * a * rest**2, atan2(speed, -belt), rest + 0.3
    places = {"puck.x": belt * end + way * cos(angle), "puck.y": way * sin(angle)}
    return _Case(scene=Scene("thrown puck", [puck, moving, sole]), t_end=end, places=places, transitions=(rest,))
