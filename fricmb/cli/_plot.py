"""``fricmb plot``: pictures, sound and views of a run that was saved."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fricmb as fm
from fricmb.cli._kinds import FREQUENCIES, KINDS, NEED_NAME, OWN_FILE, SEVERAL
from fricmb.cli._load import module_of
from fricmb.cli._output import make_folder
from fricmb.errors import SceneError, unknown_name
from fricmb.values import Declaration


def plot(options: argparse.Namespace) -> int:
    """Draw one picture of a saved run."""
    kind, name = options.kind, options.of
    if kind not in KINDS:
        raise unknown_name("picture", kind, KINDS)
    if kind in NEED_NAME and name is None:
        raise SceneError(f"fricmb plot {kind}: --of is missing: the name of a dof, contact or signal")
    path: Path = options.out or options.solution.with_name(f"{kind}{OWN_FILE.get(kind, '.png')}")
    sol = fm.Solution.load(options.solution, laws=own_laws(options.laws))
    make_folder(path.parent)
    with fm.plot.theme(options.theme):
        _draw(sol, kind, name, path, options)
    print(path)
    return 0


def own_laws(path: Path | None) -> list[type]:
    """The laws and elements of a Python file, which is run for that."""
    if path is None:
        return []
    module = module_of(path)
    held = vars(module).values()
    return [kind for kind in held if isinstance(kind, type) and issubclass(kind, Declaration)]


def _draw(sol: fm.Solution, kind: str, name: str | None, path: Path, options: argparse.Namespace) -> None:
    if kind == "animation":
        sol.plot.animation(path, t_start=options.t_start, t_end=options.t_end, frames=options.frames)
    elif kind == "sound":
        span = {"t_start": options.t_start, "t_end": options.t_end}
        sol.plot.sound(str(name), path, seconds=options.seconds, **span)
    elif kind == "view":
        sol.plot.view(path, t_start=options.t_start, t_end=options.t_end)
    else:
        draw: Callable[..., Any] = getattr(sol.plot, kind)
        given: dict[str, Any] = {"t_start": options.t_start, "t_end": options.t_end}
        if options.hz:
            if kind not in FREQUENCIES:
                raise SceneError(f"fricmb plot {kind}: --hz: only {', '.join(FREQUENCIES)} have frequencies")
            given["hz"] = True
        names = () if name is None else tuple(name.split(","))
        figure = draw(names, **given) if kind in SEVERAL and names else draw(*names, **given)
        figure.savefig(path, dpi=150)
