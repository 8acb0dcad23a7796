"""Pictures of one solution."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._arguments import first_contact, refuse
from fricmb.plot._contact import draw_cone, draw_force_history, draw_modes, draw_phases, force_window, zoom
from fricmb.plot._figure import new_picture
from fricmb.plot._fine import refined, span_of
from fricmb.plot._hysteresis import draw_hysteresis
from fricmb.plot._measured import draw_measured, measured_signals
from fricmb.plot._over_time import draw_over_time, panels_of, signal_panels
from fricmb.plot._planes import draw_path, draw_phase
from fricmb.plot._signals import SignalPlots
from fricmb.plot._style import drawn, figure_of, finish, line, name_figure, paint, panels, remark
from fricmb.plot._units import bare

if TYPE_CHECKING:
    from fricmb.solution import Solution


class SolutionPlots(SignalPlots):
    """Pictures of a solution: ``sol.plot.velocities()`` and so on.

    Each method draws a figure of its own, or into ``ax=``, and returns the figure; ``figure.savefig("name.svg")`` or
    ".pdf" writes it as lines, ".png" as points.  ``t_start=`` and ``t_end=`` draw a part of the run.  Curves are drawn
    from the dense output, so that they are smooth between the solution's times.

    Parameters
    ----------
    sol : Solution
    units : Units, optional
        For the labels; default: those of the solution, which are those of its scene.
    """

    @cached_property
    def curves(self) -> Solution:
        """The solution at the times that a plot of the whole run draws."""
        return refined(self.sol)

    @drawn
    def velocities(
        self,
        names: Iterable[str] | None = None,
        *,
        t_start: float | None = None,
        t_end: float | None = None,
        zoom: bool | tuple[float, float] | None = None,
        ax: Axes | None = None,
    ) -> Figure:
        """Velocities over time: a panel for each direction, for the modes of each body, for contacts.

        Parameters
        ----------
        names : iterable of str, optional
            Dofs, points, driven motions, and contacts (their relative velocity); default: all dofs, and where bodies
            are given by modes also the contacts.
        t_start, t_end : float, optional
            Part of the run.
        zoom : bool or (float, float), optional
            A few cycles, or this stretch of time, enlarged beside each panel; default: where there are more cycles than
            can be told apart.
        ax : Axes, optional
            Axes that take all curves.
        """
        found = panels_of(self.sol, names, self.units, rate=True, one=ax is not None)
        return self._over_time(found, t_start, t_end, zoom, ax)

    @drawn
    def positions(
        self,
        names: Iterable[str] | None = None,
        *,
        t_start: float | None = None,
        t_end: float | None = None,
        zoom: bool | tuple[float, float] | None = None,
        ax: Axes | None = None,
    ) -> Figure:
        """Positions over time: a panel for each direction, for angles, for the modes of each body.

        Parameters
        ----------
        names : iterable of str, optional
            Dofs, points, driven motions; default: all dofs.
        t_start, t_end, zoom, ax
            As :meth:`velocities`.
        """
        found = panels_of(self.sol, names, self.units, rate=False, one=ax is not None)
        return self._over_time(found, t_start, t_end, zoom, ax)

    @drawn
    def signals(
        self,
        names: Iterable[str],
        *,
        t_start: float | None = None,
        t_end: float | None = None,
        zoom: bool | tuple[float, float] | None = None,
        ax: Axes | None = None,
    ) -> Figure:
        """Any signals over time, by their names in ``sol[name]``: a panel for each kind and unit.

        Parameters
        ----------
        names : iterable of str
            ``["sole.force", "mass.x.acceleration"]``.
        t_start, t_end, zoom
            As :meth:`velocities`.
        ax : Axes, optional
            For signals of one kind.
        """
        found = signal_panels(self.sol, names, self.units)
        if ax is not None and len(found) > 1:
            kinds = ", ".join(panel.label for panel in found)
            refuse("signals", "ax", ax, f"left out for signals of several kinds ({kinds})")
        return self._over_time(found, t_start, t_end, zoom, ax)

    @drawn
    def compare(
        self,
        data: Any,
        *,
        signals: str | Iterable[str] | None = None,
        t_start: float | None = None,
        t_end: float | None = None,
        ax: Axes | None = None,
    ) -> Figure:
        """The run beside a measurement: measured values as dots, the run as a curve, the difference in words.

        Parameters
        ----------
        data : dict, array or pandas.DataFrame
            As for :func:`fricmb.fit`: ``{"t": t, "mass.x": x}``.  Times outside the run are left out.
        signals : names, optional
            Columns to use; for an array the names of its columns.  Default: all.
        t_start, t_end : float, optional
            Part of the run.
        ax : Axes, optional
            For one signal.
        """
        span = span_of(self.sol, t_start, t_end)
        return draw_measured(self.sol, measured_signals(data, signals), span, ax, self._name, self.units)

    @drawn
    def hysteresis(
        self, name: str, *, t_start: float | None = None, t_end: float | None = None, ax: Axes | None = None
    ) -> Figure:
        """Force over displacement of a contact, joint or element; the area of the loop is the energy lost.

        The force drawn is the one that resists; displacements of contacts count from the start of the part drawn.

        Parameters
        ----------
        name : str
        t_start, t_end : float, optional
            Part of the run.
        ax : Axes, optional
            With two directions, for the first one.
        """
        return draw_hysteresis(self.sol, name, span_of(self.sol, t_start, t_end), ax, self._name, self.units)

    def _over_time(
        self, found: Any, t_start: float | None, t_end: float | None, zoom: bool | tuple[float, float] | None,
        ax: Axes | None,
    ) -> Figure:  # fmt: skip
        span = span_of(self.sol, t_start, t_end)
        if isinstance(zoom, tuple):
            zoom = span_of(self.sol, *zoom)
        return draw_over_time(self.sol, found, span, zoom, ax, self._name, self._time)

    @drawn
    def phase(
        self, name: str, *, t_start: float | None = None, t_end: float | None = None, ax: Axes | None = None
    ) -> Figure:
        """Phase plane: velocity over position of a dof or point; of a contact, the plane of its relative velocity.

        For a contact in one dimension the friction force is drawn over the relative velocity.  Where there are more
        cycles than can be told apart, the last ones stand out.
        """
        span = span_of(self.sol, t_start, t_end)
        (panel,) = panels(1, ax, title=self._name, height=5.0)
        draw_phase(self.sol, name, span, panel, self.units)
        return figure_of([panel])

    @drawn
    def path(
        self,
        x: str,
        y: str | None = None,
        *,
        t_start: float | None = None,
        t_end: float | None = None,
        ax: Axes | None = None,
    ) -> Figure:
        """Path: one motion over another.

        Parameters
        ----------
        x, y : str
            Motions, ``path("pad.x", "pad.y")``, or the name of a body or point alone for its x and y: ``path("pad")``.
        """
        if y is None:
            x, y = f"{x}.x", f"{x}.y"
        (panel,) = panels(1, ax, title=self._name, height=5.0)
        draw_path(self.sol, x, y, span_of(self.sol, t_start, t_end), panel, self.units)
        return figure_of([panel])

    @drawn
    def force(
        self, contact: str, *, t_start: float | None = None, t_end: float | None = None, ax: Axes | None = None
    ) -> Figure:
        """Friction force of a contact with its cone: over time, and in its plane if there are two directions.

        The plane is drawn twice: the whole cone, and enlarged where the force was.  With ``ax`` the whole cone alone.
        """
        span = span_of(self.sol, t_start, t_end)
        sol = refined(self.sol, *span)
        planar = len(sol.force(contact)) == 2
        if ax is not None:
            (draw_cone if planar else draw_force_history)(sol, contact, ax, self.units)
            return figure_of([ax])
        close = force_window(self.sol, contact, span)
        if not planar and close is None:
            axes = panels(1, None, title=self._name, height=3.2)
            draw_force_history(sol, contact, axes[0], self.units)
            return figure_of(axes)
        figure = new_picture(7.0, 6.0 if planar else 3.2)
        top = ["time", "time"] if close is None else ["time", "near"]
        rows: list[Any] = [top, ["plane", "close"]] if planar else [top]
        named = figure.subplot_mosaic(rows, height_ratios=[1, 1.3][: len(rows)])
        name_figure(figure, self._name)
        draw_force_history(sol, contact, named["time"], self.units)
        if close is not None:
            named["time"].axvspan(*close, color=paint().quiet, alpha=0.35, linewidth=0)
            draw_force_history(refined(self.sol, *close), contact, named["near"], self.units, legend=False)
            remark(named["near"], "enlarged")
        if planar:
            draw_cone(sol, contact, named["plane"], self.units)
            zoom(sol, contact, named["close"], self.units)
        return figure

    @drawn
    def transitions(
        self, *, t_start: float | None = None, t_end: float | None = None, ax: Axes | None = None
    ) -> Figure:
        """When each contact sticks, slips or is open, and how long each of these phases lasts.

        With ``ax`` the first alone.
        """
        first_contact(self.sol, "transitions")
        span = span_of(self.sol, t_start, t_end)
        height = 3.2 + min(0.35 * len(self.sol.contact_names), 6.0)
        axes = panels(2, ax, title=self._name, height=height, sharex=True)
        draw_modes(self.sol, axes[0], span)
        if ax is None:
            draw_phases(self.sol, axes[1], self.units, span)
        axes[-1].set_xlabel(bare(self._time))
        return figure_of(axes)

    @drawn
    def energy(
        self, *, t_start: float | None = None, t_end: float | None = None, ax: Axes | None = None
    ) -> Figure:
        """Stored energies, losses and input over time; the ledger's residual below, unless ``ax`` is given.

        The residual is drawn from the dense output: between the steps it can be larger than at them, and both values
        are given.
        """
        span = span_of(self.sol, t_start, t_end)
        seen = refined(self.sol, *span)
        energy, t = seen.energy, seen.t
        axes = panels(2, ax, title=self._name, height=5.2, sharex=True, height_ratios=[3, 1])
        terms = {
            "kinetic": energy.kinetic,
            "potential": energy.potential,
            "lost to friction": energy.friction_loss,
            "lost to damping": energy.damping_loss,
            "brought in": energy.input,
        }
        shown = {name: values for name, values in terms.items() if values.any()}
        for i, (name, values) in enumerate(shown.items()):
            axes[0].plot(t, values, label=name, **line(i))
        finish(axes[0], x="", y=f"energy [{self.units.energy}]", legend=bool(shown))
        if ax is None:
            axes[1].plot(t, energy.residual, color=paint().ink, linewidth=0.7)
            finish(axes[1], x="", y="residual, relative")
            remark(axes[1], _residuals(self.sol, energy.residual, span))
        axes[-1].set_xlabel(bare(self._time))
        return figure_of(axes)

    @property
    def _time(self) -> str:
        return f"time [{self.units.time}]"


def _residuals(sol: Solution, drawn_ones: np.ndarray, span: tuple[float, float]) -> str:
    """The largest residual at the solution's times, which the summary tells, and that of the curve."""
    inside = (sol.t >= span[0]) & (sol.t <= span[1])
    own = np.abs(sol.energy.residual[inside]).max(initial=0.0)
    return f"largest {own:.1e} at the solution's times (as in its summary), {np.abs(drawn_ones).max():.1e} in the curve"
