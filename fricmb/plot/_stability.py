"""Pictures of the stability of steady sliding."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._arguments import refuse
from fricmb.plot._style import DASHES, NAMED_CURVES, THIN, drawn, figure_of, finish, line, paint, panels
from fricmb.plot._units import Units, bare

if TYPE_CHECKING:
    from fricmb.analysis import Eigenvalues, StabilityMap

#: More modes than this have no names in the legend but those that become unstable.
_LISTED = 30
#: What tells curves apart beside colours and dashes.
_SIGNS = ("o", "s", "^", "D", "v", "x", "*", "P", "<", ">")


@drawn
def eigenvalues(
    found: Eigenvalues,
    *,
    hz: bool = False,
    modes: list[int] | None = None,
    units: Units | None = None,
) -> Figure:
    """Frequencies and growth rates of the modes over the parameter, critical values as vertical lines.

    Curves go through the values between those given at which the modes were looked at.  Modes that become unstable are
    drawn thick; each is named by its number and the degree of freedom that moves most at the first value.

    Parameters
    ----------
    found : Eigenvalues
        Of :func:`fricmb.analysis.complex_eigenvalues`.
    hz : bool
        Frequencies (Hz where time is in s) instead of angular frequencies.
    modes : list of int, optional
        Only these.
    units : Units, optional
        For the labels; default: those of the scene.
    """
    from fricmb.analysis import Eigenvalues

    if not isinstance(found, Eigenvalues):
        refuse("eigenvalues", "found", found, "what complex_eigenvalues returns")
    units = found.units if units is None else units
    top, bottom = panels(2, None, height=5.2, sharex=True)
    count = found.eigenvalues.shape[1]
    chosen = list(range(count)) if modes is None else list(modes)
    if not all(0 <= mode < count for mode in chosen):
        refuse("eigenvalues", "modes", modes, f"a list of numbers of modes, 0 to {count - 1}")
    critical = {c.mode for c in found.critical}
    turn = 2.0 * np.pi if hz else 1.0
    for i, k in enumerate(chosen):
        moves = found.dofs[int(np.argmax(np.abs(found.shapes[0, k])))]
        named = len(chosen) <= _LISTED or k in critical
        style = _style(i) if named else line(i, len(chosen))
        if k in critical:
            style["linewidth"] = 2 * THIN
        top.plot(
            found.fine_values,
            np.abs(found.fine_eigenvalues[:, k].imag) / turn,
            label=f"{k}: {moves}" if named else None,
            **style,
        )
        bottom.plot(found.fine_values, found.fine_eigenvalues[:, k].real, **style)
        if named:
            _tell_apart(i, len(chosen), top.get_lines()[-1], bottom.get_lines()[-1])
    for panel in (top, bottom):
        for crossing in found.critical:
            panel.axvline(crossing.value, color=paint().ink, linewidth=0.7, linestyle=":")
    bottom.axhline(0.0, color=paint().ink, linewidth=0.7)
    label = f"frequency [{units.frequency}]" if hz else f"angular frequency [{units.angular_frequency}]"
    finish(top, x="", y=label, legend=0 < len(chosen) <= NAMED_CURVES)
    finish(bottom, x=f"{found.over} [{found.over_unit}]", y=f"growth rate [{units.rate}]")
    figure = figure_of([top, bottom])
    if len(chosen) > NAMED_CURVES:
        figure.legend(*top.get_legend_handles_labels(), loc="outside right upper", fontsize="x-small", title="mode")
    return figure


def _tell_apart(i: int, count: int, *curves: Any) -> None:
    """A sign on a curve here and there, another for each: curves that lie on one another are seen, too."""
    for curve in curves:
        curve.set_marker(_SIGNS[i % len(_SIGNS)])
        curve.set_markersize(4.0)
        curve.set_markerfacecolor("none")
        curve.set_markevery(((i + 0.5) / (5 * max(count, 1)), 0.2))


def _style(i: int) -> dict[str, Any]:
    """Of curves that are named: colours first, then dashes."""
    colours = paint().colours
    return {
        "color": colours[i % len(colours)],
        "linestyle": DASHES[(i if i < NAMED_CURVES else i // len(colours)) % len(DASHES)],
        "linewidth": THIN,
    }


@drawn
def stability(found: StabilityMap, *, ax: Axes | None = None, units: Units | None = None) -> Figure:
    """Largest growth rate over two parameters; the border of stability as a line, unstable modes hatched by number.

    Parameters
    ----------
    found : StabilityMap
        Of :func:`fricmb.analysis.stability_map`.
    ax : Axes, optional
    units : Units, optional
        For the labels; default: those of the scene.
    """
    from fricmb.analysis import StabilityMap

    if not isinstance(found, StabilityMap):
        refuse("stability", "found", found, "what stability_map returns")
    units = found.units if units is None else units
    (panel,) = panels(1, ax, height=4.2)
    y, x = found.values
    largest = float(np.abs(found.growth).max()) or 1.0
    filled = panel.contourf(
        x, y, found.growth, levels=np.linspace(-largest, largest, 15), cmap="PuOr_r", vmin=-largest, vmax=largest
    )
    if found.unstable.any():
        panel.contourf(x, y, found.unstable, levels=[0.5, np.inf], colors="none", hatches=["//"])
    if found.growth.min() < 0.0 < found.growth.max():
        panel.contour(x, y, found.growth, levels=[0.0], colors=["#404040"], linewidths=1.4)
    panel.grid(False)
    label = bare(f"largest growth rate [{units.rate}]") + " (hatched: unstable)"
    figure_of([panel]).colorbar(filled, ax=panel, label=label)
    panel.set_xlabel(bare(f"{found.over[1]} [{found.over_units[1]}]"))
    panel.set_ylabel(bare(f"{found.over[0]} [{found.over_units[0]}]"))
    return figure_of([panel])
