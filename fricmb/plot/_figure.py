"""Figures that pyplot does not manage: notebooks show them once, :func:`show` opens windows for them.

pyplot keeps each of its figures until it is closed, and importing it chooses a backend for the whole program.  Pictures
need neither, and a loop that draws and saves them leaves nothing behind.
"""

from __future__ import annotations

import io
import sys
from typing import Any

from matplotlib.figure import Figure


class Picture(Figure):
    """A matplotlib figure that notebooks show without pyplot."""

    def _repr_png_(self) -> bytes:
        """What a notebook shows."""
        held = io.BytesIO()
        self.savefig(held, format="png", dpi="figure", bbox_inches="tight")
        return held.getvalue()

    def show(self, warn: bool = True) -> None:
        """Open a window, see :func:`show`; ``warn`` stands here for matplotlib's sake and does nothing."""
        show(self)


def new_picture(width: float, height: float) -> Picture:
    """An empty figure of this size in inches."""
    return Picture(figsize=(width, height), layout="constrained")


def show(*figures: Figure) -> None:
    """Show figures in windows, and wait until they are closed; in a notebook, below the cell.

    ``plt.show()`` does the same with figures that pyplot has made.  It does not know those of fricmb.

    Parameters
    ----------
    *figures : matplotlib Figure
        For example ``fm.plot.show(sol.plot.velocities(), sol.plot.phase("mass.x"))``.
    """
    import matplotlib.pyplot as plt

    for figure in figures:
        manager = figure.canvas.manager
        if manager is None or not plt.fignum_exists(manager.num):
            # pyplot makes a window for whatever figure this function gives it
            plt.figure(FigureClass=lambda *_, figure=figure, **__: figure)  # type: ignore[arg-type]
    plt.show()


class _Cell:
    """What the running cell of a notebook has made and not shown yet."""

    def __init__(self) -> None:
        self.waiting: dict[int, Picture] = {}
        self._watched: Any = None

    def watch(self, shell: Any) -> None:
        """Be called at the end of each cell."""
        if self._watched is not shell:
            self._watched = shell
            shell.events.register("pre_execute", self.waiting.clear)
            shell.events.register("post_execute", self.show)

    def add(self, picture: Picture) -> None:
        """Show a picture at the end of the cell, unless it is drawn before: displayed, or saved to a file."""
        self.waiting[id(picture)] = picture
        picture.canvas.mpl_connect("draw_event", lambda event: self.waiting.pop(id(picture), None))

    def show(self) -> None:
        """Show what nobody has seen."""
        import IPython.display

        display: Any = IPython.display.display
        for picture in list(self.waiting.values()):
            display(picture)
        self.waiting.clear()


_CELL = _Cell()


def offer(picture: Picture) -> None:
    """Let the running cell of a notebook show a picture at its end; outside of notebooks nothing happens.

    Notebooks show what the last line of a cell returns; ``figure = sol.plot.phase("mass.x")`` returns nothing.
    """
    held = sys.modules.get("IPython")
    shell = held.get_ipython() if held is not None else None
    if shell is not None and "image/png" in shell.display_formatter.active_types:
        _CELL.watch(shell)
        _CELL.add(picture)
