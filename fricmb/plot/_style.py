"""Colours, line styles, themes and figures that all pictures share.

What a picture looks like stands in two style sheets, ``light.mplstyle`` and ``dark.mplstyle``, which differ in colours
alone; everything that is drawn takes its colours from the sheet in use.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, ParamSpec, TypeVar

import matplotlib as mpl
import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from fricmb.errors import unknown_name
from fricmb.plot._arguments import looked_at
from fricmb.plot._figure import Picture, new_picture, offer
from fricmb.plot._units import bare

_P = ParamSpec("_P")
_R = TypeVar("_R")

THEMES = ("light", "dark")
_SHEETS = {
    name: dict(mpl.rc_params_from_file(Path(__file__).with_name(f"{name}.mplstyle"), use_default_template=False))
    for name in THEMES
}
#: The colours of the light sheet: those first that are dark enough for print.
COLOURS: tuple[str, ...] = tuple(f"#{c.lstrip('#')}" for c in _SHEETS["light"]["axes.prop_cycle"].by_key()["color"])
BLUE, ORANGE, DARK = COLOURS[:3]
#: Told apart without colour as well.
DASHES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (6, 1.5, 1.2, 1.5)), (0, (8, 2)), (0, (2, 1)))
THIN = 0.9
#: More curves than this are shaded from first to last instead of named one by one.
NAMED_CURVES = 8


@dataclass(frozen=True, kw_only=True)
class Paint:
    """Colours of a theme.

    Attributes
    ----------
    colours : tuple of str
        Of curves, in their order.
    stick, slip : str
        What tells stick from slip; also first and second colour.
    ink, quiet : str
        Lines that are no curves, and those that stand back.
    body, moved, paper : str
        Faces of bodies, of those whose motion is prescribed, and the background.
    shades : (float, float)
        Part of the colour map that is told from the background.
    """

    colours: tuple[str, ...]
    stick: str
    slip: str
    ink: str
    quiet: str
    body: str
    moved: str
    paper: str
    shades: tuple[float, float]


_PAINTS = {
    "light": Paint(
        colours=COLOURS,
        stick=BLUE, slip=ORANGE, ink=DARK, quiet="#9a9a9a", body="#d9dee4", moved="#f1ece2", paper="white",
        shades=(0.0, 0.9),
    ),
    "dark": Paint(
        colours=tuple(f"#{c.lstrip('#')}" for c in _SHEETS["dark"]["axes.prop_cycle"].by_key()["color"]),
        stick="#6DB3E6", slip="#FF9A3C", ink="#C8CDD4", quiet="#77808c", body="#333d49", moved="#403a2e",
        paper="#14181e", shades=(0.2, 1.0),
    ),
}  # fmt: skip

_chosen: str | None = None
#: The theme of the picture that is being drawn.
_drawing: list[str] = []


def use(name: str | None) -> None:
    """Draw all further pictures for a light or for a dark page.

    Parameters
    ----------
    name : {"light", "dark", None}
        None, as at the start: dark where matplotlib's own figures are dark (``plt.style.use("dark_background")``).
    """
    global _chosen
    if name is not None and not (isinstance(name, str) and name in THEMES):
        raise unknown_name("theme", name, THEMES)
    _chosen = name


@contextmanager
def theme(name: str | None) -> Iterator[None]:
    """The same for what is drawn inside: ``with fm.plot.theme("dark"): sol.plot.velocities()``."""
    before = _chosen
    use(name)
    try:
        yield
    finally:
        use(before)


def _is_dark(colour: Any) -> bool:
    red, green, blue = to_rgb(colour)
    return 0.3 * red + 0.6 * green + 0.1 * blue < 0.4


def theme_in_use(ax: Axes | None = None) -> str:
    """The theme chosen, or that which suits the axes, or new figures of matplotlib."""
    if _chosen is not None:
        return _chosen
    face: Any = ax.get_facecolor() if ax is not None else mpl.rcParams["figure.facecolor"]
    return "dark" if _is_dark(face) else "light"


@contextmanager
def _sheet(name: str) -> Iterator[None]:
    """The settings of a style sheet, for what is drawn inside.

    Only they are put back.  ``rc_context`` puts back all, also what others change meanwhile: pyplot, imported inside,
    would lose its interactive mode, and with it the display of all figures in a notebook.
    """
    sheet = _SHEETS[name]
    before = {key: mpl.rcParams[key] for key in sheet}
    mpl.rcParams.update(sheet)
    try:
        yield
    finally:
        mpl.rcParams.update(before)


def drawn(method: Callable[_P, _R]) -> Callable[_P, _R]:
    """Let a function draw with the style sheet of the theme in use; its options are looked at before.

    A notebook is offered the picture.
    """

    @looked_at
    @functools.wraps(method)
    def draws(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        ax: Any = kwargs.get("ax")
        name = theme_in_use(ax)
        _drawing.append(name)
        try:
            with _sheet(name):
                picture = method(*args, **kwargs)
        finally:
            _drawing.pop()
        if isinstance(picture, Picture):
            offer(picture)
        return picture

    return draws


def paint() -> Paint:
    """Colours of the picture that is being drawn."""
    return _PAINTS[_drawing[-1] if _drawing else theme_in_use()]


def line(i: int, count: int = 1) -> dict[str, Any]:
    """Style of the i-th of ``count`` curves of a picture."""
    colours = paint().colours
    if count > NAMED_CURVES:
        low, high = paint().shades
        return {"color": mpl.colormaps["cividis"](low + (high - low) * i / (count - 1)), "linewidth": 0.5}
    return {"color": colours[i % len(colours)], "linestyle": DASHES[i % len(DASHES)], "linewidth": THIN}


def panels(count: int, ax: Axes | None, *, title: str = "", **options: Any) -> list[Axes]:
    """``count`` panels of a new figure one above the other under a title, or the given axes as the only one."""
    if ax is not None:
        return [ax]
    figure = new_picture(7.0, options.pop("height", 2.4 * count + 0.8))
    axes = figure.subplots(count, 1, squeeze=False, **options)
    name_figure(figure, title)
    return list(axes[:, 0])


def name_figure(figure: Figure, title: str) -> None:
    """A title above all panels and their legends, at the left."""
    if title:
        figure.suptitle(title, x=0.01, ha="left", fontsize="medium")


def remark(ax: Axes, text: str, *, loc: Literal["left", "right"] = "right") -> None:
    """What has to be said about a panel, above it; at the left where there is a legend."""
    ax.set_title(text, loc=loc, fontsize="small")


@looked_at
def finish(ax: Axes, *, x: str, y: str, legend: bool = False, columns: int = 4) -> None:
    """Labels, a quiet grid, and a legend above the panel, where no curve is.

    Units in brackets that say nothing are left out: "velocity [1]" is "velocity".
    """
    ax.set_xlabel(bare(x))
    ax.set_ylabel(bare(y))
    ax.grid(True, linewidth=0.4, alpha=0.5)
    ax.margins(x=0.01)
    if legend:
        ax.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=min(len(ax.get_legend_handles_labels()[0]), columns),
            fontsize="small",
            frameon=False,
            borderaxespad=0.1,
            columnspacing=1.2,
        )


def few_labels(axis: Axis, low: float, high: float) -> None:
    """Labels of a logarithmic axis that stay apart: powers of ten, over few decades also numbers between them."""
    decades = np.log10(high / low)
    subs = (1.0, 2.0, 5.0) if decades < 1.2 else (1.0, 3.0) if decades < 2.0 else (1.0,)
    axis.set_major_locator(LogLocator(subs=subs, numticks=8))
    if decades < 2.0:
        axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def figure_of(axes: list[Axes]) -> Figure:
    """The figure that panels are in."""
    figure = axes[0].figure
    return figure if isinstance(figure, Figure) else figure.figure
