"""Pictures of the stability of steady sliding."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._arguments import refuse
from fricmb.plot._style import DASHES, NAMED_CURVES, THIN, drawn, figure_of, finish, line, paint, panels
from fricmb.plot._units import Units

if TYPE_CHECKING:
    from fricmb.analysis import Eigenvalues, StabilityMap

#: More modes than this have no names in the legend but those that become unstable.
_LISTED = 30


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
    for panel in (top, bottom):
        for crossing in found.critical:
            panel.axvline(crossing.value, color=paint().ink, linewidth=0.7, linestyle=":")
    bottom.axhline(0.0, color=paint().ink, linewidth=0.7)
    label = f"frequency [{units.frequency}]" if hz else f"angular frequency [{units.angular_frequency}]"
    finish(top, x="", y=label, legend=0 < len(chosen) <= NAMED_CURVES)
    finish(bottom, x=found.over, y=f"growth rate [{units.rate}]")
    figure = figure_of([top, bottom])
    if len(chosen) > NAMED_CURVES:
        figure.legend(*top.get_legend_handles_labels(), loc="outside right upper", fontsize="x-small", title="mode")
    return figure


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
    label = f"largest growth rate [{units.rate}] (hatched: unstable)"
    figure_of([panel]).colorbar(filled, ax=panel, label=label)
    panel.set_xlabel(found.over[1])
    panel.set_ylabel(found.over[0])
    return figure_of([panel])
