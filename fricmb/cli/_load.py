"""From the MODEL of the command line to a scene."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import fricmb as fm
from fricmb.errors import FricmbError, SceneError, shown, unknown_name
from fricmb.models import catalogue
from fricmb.values import DIMENSIONS, Units


@dataclass(frozen=True, kw_only=True)
class Loaded:
    """A scene with what its source says about a run: ``t_end`` may be None; ``label`` is fit for a folder's name."""

    scene: fm.Scene
    label: str
    t_end: float | None


def load(model: str, *, case: str | None = None, values: Sequence[str] = ()) -> Loaded:
    """The scene of a built-in model or of a Python file, with the settings of the command line."""
    settings = dict(setting(text) for text in values)
    if case is not None:
        settings = {"case": case, **settings}
    if model in catalogue:
        known = catalogue[model]
        return _built_in(model, settings, known.build, known.t_end)
    if model.endswith(".py") or Path(model).is_file():
        return _from_file(Path(model), settings)
    found, broken = fm.laws.published("fricmb.models")
    if model in found:
        return _built_in(model, settings, found[model], None)
    if model in broken:
        raise SceneError(f"model {model!r}: {broken[model]}")
    raise unknown_name("model", model, [*catalogue, *found])


def setting(text: str) -> tuple[str, Any]:
    """``name=value``; a value that is no Python literal is a string."""
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise SceneError(f"--set: expected NAME=VALUE; got {shown(text)}")
    try:
        return name.strip(), ast.literal_eval(value.strip())
    except (SyntaxError, ValueError):
        return name.strip(), _law(value.strip()) or value.strip()


def _law(text: str) -> fm.FrictionLaw | None:
    """``Coulomb(mu_s=0.5)`` as the law that it names, None for other text: read, not executed."""
    try:
        call = ast.parse(text, mode="eval").body
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name)):
            return None
        if call.func.id not in fm.laws.names:
            raise unknown_name("law", call.func.id, fm.laws.names)
        return getattr(fm.laws, call.func.id)(  # type: ignore[no-any-return]
            *map(ast.literal_eval, call.args), **{k.arg or "": ast.literal_eval(k.value) for k in call.keywords}
        )
    except (SyntaxError, ValueError) as error:
        if isinstance(error, FricmbError):
            raise
        return None


def _built_in(name: str, settings: dict[str, Any], build: Callable[..., Any], t_end: float | None) -> Loaded:
    arguments = inspect.signature(build).parameters
    own = {key: value for key, value in settings.items() if key in arguments}
    if "case" in settings and "case" not in arguments:
        raise SceneError(f"--case: {name} has no cases; its arguments are {', '.join(arguments)}")
    try:
        scene = build(**own)
    except (TypeError, ValueError) as error:
        if isinstance(error, FricmbError):
            raise
        raise SceneError(f"{name}: {error}; given {', '.join(f'{k}={v!r}' for k, v in own.items())}") from None
    label = "-".join([name, *(f"{key}-{value}" for key, value in own.items() if key == "case")])
    rest = {key: value for key, value in settings.items() if key not in own}
    try:
        scene = _with_parameters(scene, rest)
    except KeyError as error:
        raise SceneError(f"--set: {error}; arguments of {name}: {', '.join(arguments)}") from None
    return Loaded(scene=scene, label=label, t_end=t_end)


def _from_file(path: Path, settings: dict[str, Any]) -> Loaded:
    module = module_of(path)
    scene = getattr(module, "scene", None)
    if not isinstance(scene, fm.Scene):
        found = "none" if scene is None else repr(scene)
        raise SceneError(f"{path}: expected a module-level scene = fricmb.Scene(...); found {found}")
    t_end = getattr(module, "t_end", None)
    units = getattr(module, "units", None)
    if isinstance(units, Units) and scene.units == DIMENSIONS:
        scene = scene.with_units(units)
    if "case" in settings:
        raise SceneError(f"--case: {path} is a file; only a built-in model has cases")
    return Loaded(scene=_with_parameters(scene, settings), label=path.stem, t_end=t_end)


def module_of(path: Path) -> ModuleType:
    """The file as a module that is known by name, so that laws defined in it can be derived and pickled."""
    if not path.is_file():
        raise SceneError(f"there is no file {str(path)!r}")
    name = "fricmb_scene_" + re.sub(r"\W", "_", path.stem)
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise SceneError(f"{path}: not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    sys.path.insert(0, str(path.resolve().parent))
    try:
        spec.loader.exec_module(module)
    except SceneError:
        raise
    except Exception as error:
        raise SceneError(f"{_place(error, path)}: {type(error).__name__}: {error}") from error
    finally:
        sys.path.pop(0)
    return module


def _place(error: Exception, path: Path) -> str:
    """``file:line`` where the user's file failed."""
    line, trace = None, error.__traceback__
    while trace is not None:
        if Path(trace.tb_frame.f_code.co_filename).resolve() == path.resolve():
            line = trace.tb_lineno
        trace = trace.tb_next
    if isinstance(error, SyntaxError):
        line = error.lineno
    return str(path) if line is None else f"{path}:{line}"


def _with_law(scene: fm.Scene, name: str, law: fm.FrictionLaw) -> fm.Scene:
    """The scene with another law: ``sole.law=...``, or ``sole.friction=...`` of a joint."""
    owner, _, field = name.rpartition(".")
    known = [f"{part.name}.law" for part in scene.parts if isinstance(part, fm.Contact)]
    known += [f"{part.name}.friction" for part in scene.parts if isinstance(part, fm.Joint) and part.friction]
    if name not in known:
        raise unknown_name("law in --set", name, known)
    return scene.replace(owner, **{field: law})


def _with_parameters(scene: fm.Scene, values: dict[str, Any]) -> fm.Scene:
    for name, value in dict(values).items():
        if isinstance(value, fm.FrictionLaw):
            scene = _with_law(scene, name, value)
            del values[name]
        elif name in scene.parameters and not isinstance(value, (int, float, tuple, list)):
            raise SceneError(f"--set: {name} takes a number; got {shown(value)}")
    return scene.with_parameters(values) if values else scene
