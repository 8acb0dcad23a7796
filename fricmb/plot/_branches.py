"""Pictures of branches of cycles and of bifurcation diagrams."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._figure import new_picture
from fricmb.plot._style import drawn, figure_of, finish, paint, panels
from fricmb.plot._units import unit_of
from fricmb.scene import parameter_unit

if TYPE_CHECKING:
    from fricmb.analysis import BifurcationDiagram, Branch, Cycle

#: Shapes of special points, in the order in which kinds appear.
_MARKS = ("o", "s", "D", "^", "v", "P", "X")


class BranchPlots:
    """Pictures of a branch: ``branch.plot.diagram()`` and so on.

    Each method draws a figure of its own, or into ``ax=``, and returns the figure.

    Parameters
    ----------
    branch : Branch
    """

    def __init__(self, branch: Branch) -> None:
        self.branch = branch

    @drawn
    def diagram(self, name: str | None = None, *, ax: Axes | None = None, label: str | None = None) -> Figure:
        """Amplitudes, or periods, over the parameter: stable cycles solid, unstable ones dashed, special points marked.

        Parameters
        ----------
        name : str, optional
            A degree of freedom or point, or "period"; default: the first degree of freedom.
        ax : Axes, optional
            Draw several branches into one panel.
        label : str, optional
            Of the branch in the legend.
        """
        branch, units = self.branch, self.branch.cycles[0].scene.units
        name = branch.cycles[0].scene.dof_names[0] if name is None else name
        (panel,) = panels(1, ax, height=4.2)
        colour = paint().colours[sum(1 for line in panel.get_lines() if line.get_gid() == "branch") % 2]
        for i, (cycles, stable) in enumerate(self._stretches()):
            x = [float(cycle.scene.parameters[branch.over]) for cycle in cycles]
            kind = "stable" if stable else "unstable"
            text = f"{label}, {kind}" if label else kind
            drawn_as: dict[str, Any] = {"linestyle": "-", "linewidth": 1.6}
            if not stable:
                drawn_as = {"linestyle": (0, (5, 2)), "linewidth": 1.2}
            known = panel.get_legend_handles_labels()[1]
            y = [_measure(cycle, name) for cycle in cycles]
            (curve,) = panel.plot(x, y, color=colour, label=None if text in known else text, **drawn_as)
            curve.set_gid("branch" if i == 0 else None)
        self._mark(panel, name)
        unit = units.time if name == "period" else unit_of(name, units)
        measured = f"period [{unit}]" if name == "period" else f"amplitude of {name} [{unit}]"
        over_unit = parameter_unit(branch.cycles[0].scene, branch.over)
        finish(panel, x=f"{branch.over} [{over_unit}]", y=measured, legend=True)
        return figure_of([panel])

    @drawn
    def multipliers(self, *, ax: Axes | None = None) -> Figure:
        """Floquet multipliers along the branch in the complex plane, with the unit circle; the last cycles are dark.

        With ``ax`` the plane alone; else beside it their magnitudes along the branch.
        """
        branch = self.branch
        if ax is None:
            figure = new_picture(8.0, 3.8)
            plane, along = figure.subplots(1, 2)
        else:
            plane, along = ax, None
        angle = np.linspace(0.0, 2.0 * np.pi, 361)
        plane.plot(np.cos(angle), np.sin(angle), color=paint().quiet, linewidth=0.9)
        steps = np.concatenate([np.full(cycle.multipliers.size, i) for i, cycle in enumerate(branch.cycles)])
        found = np.concatenate([cycle.multipliers for cycle in branch.cycles])
        shown = plane.scatter(found.real, found.imag, c=steps, cmap="cividis_r", s=12)
        plane.set_aspect("equal", adjustable="datalim")
        finish(plane, x="real part", y="imaginary part")
        if along is not None:
            along.scatter(steps, np.abs(found), c=steps, cmap="cividis_r", s=12)
            along.axhline(1.0, color=paint().quiet, linewidth=0.9)
            along.set_yscale("symlog", linthresh=1e-3)
            along.set_ylim(bottom=0.0)
            finish(along, x="cycle along the branch", y="magnitude")
            figure.colorbar(shown, ax=along, label="cycle along the branch")
        return figure_of([plane])

    def _stretches(self) -> Iterator[tuple[list[Cycle], bool]]:
        """Neighbours of one stability, the special points between them at the ends of both."""
        branch = self.branch
        held: list[Cycle] = []
        stable = branch.cycles[0].stable
        for i, cycle in enumerate(branch.cycles):
            between = [s.cycle for s, place in zip(branch.special, branch.places, strict=True) if place == i]
            if held and cycle.stable != stable:
                yield [*held, *between], stable
                held, stable = between[-1:] or held[-1:], cycle.stable
            else:
                held += between
            held.append(cycle)
        yield held, stable

    def _mark(self, panel: Axes, name: str) -> None:
        kinds = list(dict.fromkeys(type(special).__name__ for special in self.branch.special))
        known = panel.get_legend_handles_labels()[1]
        for i, kind in enumerate(kinds):
            here = [special for special in self.branch.special if type(special).__name__ == kind]
            text = None if _spaced(kind) in known else _spaced(kind)
            panel.plot(
                [s.value for s in here],
                [_measure(s.cycle, name) for s in here],
                linestyle="none",
                marker=_MARKS[i % len(_MARKS)],
                markersize=9 - 3 * (i % 2),
                markerfacecolor="none" if i % 2 == 0 else paint().ink,
                color=paint().ink,
                label=text,
            )


class DiagramPlots:
    """Pictures of a bifurcation diagram: ``found.plot.diagram()``.

    Parameters
    ----------
    found : BifurcationDiagram
    """

    def __init__(self, found: BifurcationDiagram) -> None:
        self.found = found

    @drawn
    def diagram(self, *, ax: Axes | None = None) -> Figure:
        """The signal at the passes of the section over the parameter."""
        found = self.found
        (panel,) = panels(1, ax, height=4.2)
        x = np.concatenate([np.full(p.size, v) for v, p in zip(found.values, found.points, strict=True)])
        y = np.concatenate([*found.points, np.zeros(0)])
        panel.plot(x, y, ".", markersize=1.5, color=paint().ink)
        finish(panel, x=found.over, y=f"{found.signal} at the section")
        return figure_of([panel])


def _measure(cycle: Cycle, name: str) -> float:
    return cycle.period if name == "period" else cycle.amplitude(name)


def _spaced(kind: str) -> str:
    """StickAppears -> stick appears; a name stays one."""
    if kind == "NeimarkSacker":
        return "Neimark-Sacker"
    return "".join(f" {c.lower()}" if c.isupper() else c for c in kind).strip()
