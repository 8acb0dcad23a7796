"""Whether a model, a function that returns a scene, keeps what the command line, sweeps and runs rely on."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator

import numpy as np

from fricmb._calls import answers
from fricmb.errors import FricmbError, shown
from fricmb.integrate import Integrator
from fricmb.scene import Scene
from fricmb.testing._base import ConformanceError, Rule, findings, pickles
from fricmb.testing._model_run import Trip, run_findings

Model = Callable[..., Scene]


@answers
def check_model(
    model: Model,
    *,
    run: bool = True,
    t_end: float = 1.0,
    method: str | Integrator = "auto",
    rtol: float = 1e-6,
    bound: float = 1e-4,
) -> None:
    """Try the rules that a run relies on.

    Parameters
    ----------
    model : callable
        A function that returns a Scene; each of its arguments has a default.
    run : bool
        Whether to simulate it too; it is, four times over ``t_end`` or less.
    t_end : float
        Duration of that run, in the model's unit of time.
    method : str or Integrator
    rtol : float
        Of the run.
    bound : float
        Greatest residual of the energy ledger, relative to its largest term, and greatest difference at the end
        between a run and the same in two halves, relative to the largest coordinate or velocity.  Take a longer
        look at a chaotic model with a short ``t_end``.

    Raises
    ------
    ConformanceError
        Naming each broken rule with what shows it.

    Notes
    -----
    Default arguments give a Scene, equal from call to call, whose names are unique; it pickles; its parameters can be
    set one by one and all at once; it has a plan and equations; nan for an argument that is a number by default is
    refused by an error of fricmb that names the argument or the part that it went to.  A run ends at ``t_end``, is
    finite, keeps its energy ledger, is the same to the last digit when repeated, goes on from its middle, and comes
    back from a file.

    Examples
    --------
    >>> import fricmb as fm
    >>> fm.testing.check_model(fm.models.belt_oscillator, run=False)
    """
    name = getattr(model, "__name__", repr(model))
    try:
        scene = model()
    except Exception as error:
        raise ConformanceError(f"{name}: default arguments fail: {type(error).__name__}: {error}") from error
    if not isinstance(scene, Scene):
        raise ConformanceError(f"{name}: must return a Scene, got {shown(scene)}")
    rules: list[Rule] = [pickles, _same, _unique, _round_trip, _settable, _derives, _refuses]
    if run:
        rules.append(lambda scene, _: run_findings(scene, Trip(t_end=t_end, method=method, rtol=rtol, bound=bound)))
    findings(name, rules, scene, model)


def _same(scene: Scene, model: Model) -> Iterator[str]:
    again = model()
    if again != scene:
        other = [a.name for a, b in zip(scene.parts, again.parts, strict=False) if a != b] or ["number of parts"]
        yield f"two calls give two scenes, which differ in {', '.join(other)}"


def _unique(scene: Scene, model: Model) -> Iterator[str]:
    names = {"parts": [part.name for part in scene.parts], "motions": scene.motion_names}
    for what, held in names.items():
        twice = sorted({name for name in held if list(held).count(name) > 1})
        if twice:
            yield f"{what} share the names {', '.join(twice)}"


def _round_trip(scene: Scene, model: Model) -> Iterator[str]:
    try:
        again = scene.with_parameters(scene.parameters)
    except Exception as error:
        yield f"with_parameters refuses the scene's own parameters: {type(error).__name__}: {error}"
        return
    if again != scene:
        yield "with_parameters of the scene's own parameters gives another scene"


def _settable(scene: Scene, model: Model) -> Iterator[str]:
    """Another value arrives, and the old one makes the old scene."""
    for path, value in scene.parameters.items():
        if not isinstance(value, float | int):
            continue
        other = value * 1.0009765625 if value else 2.0**-10
        try:
            changed = scene.with_parameters({path: other})
        except FricmbError:
            continue  # bounds that the other value breaks
        except Exception as error:
            yield f"the parameter {path} = {other:g} cannot be set: {type(error).__name__}: {error}"
            continue
        if changed.parameters.get(path) != other:
            yield f"the parameter {path} is set to {other!r}, but is {changed.parameters.get(path)!r}"


def _derives(scene: Scene, model: Model) -> Iterator[str]:
    """A plan that can be printed, and equations of the size of the scene."""
    try:
        str(scene.plan())
    except Exception as error:
        yield f"plan() fails: {type(error).__name__}: {error}"
    try:
        equations, n = scene.equations(), len(scene.dof_names)
        shape = np.shape(equations.M)
        if shape != (n, n) or len(equations.rhs) != n:
            yield f"equations() of {n} degrees of freedom have a mass matrix of shape {shape}"
    except Exception as error:
        yield f"equations() fails: {type(error).__name__}: {error}"


def _refuses(scene: Scene, model: Model) -> Iterator[str]:
    """Nan in place of every argument that is a number by default."""
    for name, argument in inspect.signature(model).parameters.items():
        if isinstance(argument.default, bool) or not isinstance(argument.default, float | int):
            continue
        try:
            model(**{name: float("nan")})
        except FricmbError as error:
            if not _names(str(error), name, scene):
                yield f"{name} = nan is refused, but neither it nor a part is named: {error}"
        except Exception as error:
            yield f"{name} = nan is refused by {type(error).__name__}, which is no SceneError: {error}"
        else:
            yield f"{name} = nan is accepted"


def _names(message: str, argument: str, scene: Scene) -> bool:
    """Whether a message names an argument, or a part of the scene or the kind of one."""
    laws = [type(part.law).__name__ for part in scene.contacts]
    return any(word in message for word in (argument, *(repr(part.name) for part in scene.parts), *laws))
