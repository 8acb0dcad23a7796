"""Colours, line styles and figures that all pictures share."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import matplotlib.style
from matplotlib.axes import Axes
from matplotlib.figure import Figure

_PALETTE = [entry["color"] for entry in mpl.style.library["tableau-colorblind10"]["axes.prop_cycle"]]
#: Matplotlib's palette for colour-blind readers, those first that are dark enough for print.
COLOURS: tuple[str, ...] = tuple(_PALETTE[i] for i in (0, 1, 3, 5, 4, 7, 2, 6, 8, 9))
BLUE, ORANGE, DARK = COLOURS[:3]
#: Told apart without colour as well.
DASHES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (6, 1.5, 1.2, 1.5)), (0, (8, 2)), (0, (2, 1)))
THIN = 0.9


#: More curves than this are shaded from first to last instead of named one by one.
NAMED_CURVES = 8


def line(i: int, count: int = 1) -> dict[str, Any]:
    """Style of the i-th of ``count`` curves of a picture."""
    if count > NAMED_CURVES:
        return {"color": mpl.colormaps["cividis"](0.9 * i / (count - 1)), "linewidth": 0.5}
    return {"color": COLOURS[i % len(COLOURS)], "linestyle": DASHES[i % len(DASHES)], "linewidth": THIN}


def panels(count: int, ax: Axes | None, *, title: str = "", **options: Any) -> list[Axes]:
    """``count`` panels of a new figure one above the other under a title, or the given axes as the only one."""
    if ax is not None:
        return [ax]
    import matplotlib.pyplot as plt  # a figure of its own is one that plt.show() shows

    height = options.pop("height", 2.4 * count + 0.8)
    figure, axes = plt.subplots(count, 1, figsize=(7.0, height), layout="constrained", squeeze=False, **options)
    assert isinstance(figure, Figure)
    axes[0, 0].set_title(title, loc="left", fontsize="medium")
    return list(axes[:, 0])


def remark(ax: Axes, text: str) -> None:
    """What has to be said about a panel, above it at the right."""
    ax.set_title(text, loc="right", fontsize="small")


def finish(ax: Axes, *, x: str, y: str, legend: bool = False) -> None:
    """Labels, a quiet grid, and a legend above the panel, where no curve is."""
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    ax.grid(True, linewidth=0.4, alpha=0.5)
    ax.margins(x=0.01)
    if legend:
        ax.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=min(len(ax.get_legend_handles_labels()[0]), 4),
            fontsize="small",
            frameon=False,
            borderaxespad=0.1,
            columnspacing=1.2,
        )


def figure_of(axes: list[Axes]) -> Figure:
    """The figure that panels are in."""
    figure = axes[0].figure
    return figure if isinstance(figure, Figure) else figure.figure
