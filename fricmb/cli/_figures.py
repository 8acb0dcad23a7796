"""``fricmb figures``: the figures of the brake's source, and a page for each case."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import fricmb as fm
from fricmb.cli._output import make_folder
from fricmb.errors import unknown_name
from fricmb.models.brake4dof import CASES, brake4dof
from fricmb.models.brake_paper import FIGURES, T_END, run
from fricmb.plot import SolutionPlots

#: Models whose source has figures.
MODELS = ("brake4dof",)


def figures(options: argparse.Namespace) -> int:
    """Draw every figure of the source with what it says and what we find, and a page for each case."""
    if options.model not in MODELS:
        raise unknown_name("model with figures", options.model, MODELS)
    cases = options.case or list(CASES)
    for case in cases:
        brake4dof(case)  # a wrong case is told before anything runs
    folder: Path = options.out
    make_folder(folder)
    for case in cases:
        sol = run(str(case), t_end=options.t_end, rtol=options.rtol)
        path = folder / f"brake4dof-case{case}.{options.format}"
        page(sol, f"brake4dof, case {case}").savefig(path, dpi=150)
        print(path)
    if options.t_end >= T_END:
        for path in _paper(folder, cases, options):
            print(path)
    else:
        print(f"figures of the source left out: they need the whole braking, --t-end {T_END:g}")
    return 0


def _paper(folder: Path, cases: list[str], options: argparse.Namespace) -> Iterator[Path]:
    """The figures of the source, and a text of statements and findings."""
    lines: list[str] = []
    for number, figure in FIGURES.items():
        if figure.case not in cases:
            continue
        sol = run(figure.case, t_end=options.t_end, rtol=options.rtol)
        path = folder / f"figure{number:02d}.{options.format}"
        figure.draw(sol).savefig(path, dpi=150)
        findings = [f"  {finding}" for finding in figure.check(sol)]
        lines += [figure.title, f"  {figure.shows}", *findings, ""]
        yield path
        print("\n".join(findings))
    text = folder / "findings.txt"
    text.write_text("\n".join(lines), encoding="utf-8")
    yield text


def page(sol: fm.Solution, title: str) -> Figure:
    """Six panels on one page."""
    figure = Figure(figsize=(10.0, 9.5), layout="constrained")
    axes = figure.subplots(3, 2)
    plots = SolutionPlots(sol)
    plots.velocities(["pad.x", "rotor.x"], ax=axes[0, 0])
    plots.velocities(["pad.y", "rotor.y"], ax=axes[0, 1])
    plots.phase("pad.x", ax=axes[1, 0])
    plots.phase("pad.y", ax=axes[1, 1])
    _angle(plots.curves, axes[2, 0])
    plots.transitions(ax=axes[2, 1])
    figure.suptitle(title)
    return figure


def _angle(sol: fm.Solution, ax: Axes) -> None:
    """Direction of the friction force against the direction of braking."""
    force = sol.force("lining")
    ax.plot(sol.t, np.degrees(np.arctan2(force[1], force[0])), linewidth=0.6)
    ax.set_xlabel("time")
    ax.set_ylabel("angle of the friction force [degrees]")
    ax.grid(True, linewidth=0.4, alpha=0.5)
