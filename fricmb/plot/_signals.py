"""Pictures of signals of a run: spectra, moving pictures, sound, an interactive view."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._arguments import first_contact, looked_at
from fricmb.plot._fine import span_of
from fricmb.plot._style import drawn, figure_of, panels
from fricmb.plot._units import Units, unit_of_signal

if TYPE_CHECKING:
    from fricmb.solution import Solution


class SignalPlots:
    """The part of ``sol.plot`` that is about signals."""

    def __init__(self, sol: Solution, units: Units | None = None) -> None:
        self.sol = sol
        self.units = sol.units if units is None else units

    @drawn
    def spectrum(
        self,
        name: str,
        *,
        highest: float | None = None,
        hz: bool = False,
        t_start: float | None = None,
        t_end: float | None = None,
        ax: Axes | None = None,
    ) -> Figure:
        """Maximum-entropy spectrum of a signal ("pad.y", "lining.force.x", ...) with its peaks.

        Parameters
        ----------
        name : str
        highest : float, optional
            Largest angular frequency, with ``hz`` frequency; default: what the sampling allows.
        hz : bool
            Over frequency (Hz where time is in s) instead of angular frequency.
        t_start, t_end : float, optional
            Part of the run.
        ax : Axes, optional
        """
        from fricmb.analysis import uniform
        from fricmb.plot._spectra import Axis, draw_spectrum

        (panel,) = panels(1, ax, title=self._name, height=3.4)
        signal = uniform(self.sol, name, t_start=t_start, t_end=t_end)
        draw_spectrum(signal, highest, panel, Axis.of(hz, self.units), self._unit(name))
        return figure_of([panel])

    @drawn
    def spectrogram(
        self,
        name: str,
        *,
        highest: float | None = None,
        segment: int | None = None,
        hz: bool = False,
        t_start: float | None = None,
        t_end: float | None = None,
        ax: Axes | None = None,
    ) -> Figure:
        """Running spectrum of a signal over time and frequency; ``segment``: samples in each piece of time."""
        from fricmb.analysis import spectrogram, uniform
        from fricmb.plot._spectra import Axis, draw_spectrogram

        (panel,) = panels(1, ax, title=self._name, height=3.8)
        signal = uniform(self.sol, name, t_start=t_start, t_end=t_end)
        running = spectrogram(signal.x, signal.dt, t_start=float(signal.t[0]), segment=segment)
        time, unit = f"time [{self.units.time}]", self._unit(name)
        draw_spectrogram(running, name, highest, panel, Axis.of(hz, self.units), time, unit)
        return figure_of([panel])

    @drawn
    def orders(
        self,
        name: str,
        contact: str | None = None,
        *,
        highest: float | None = None,
        segment: int | None = None,
        hz: bool = False,
        t_start: float | None = None,
        t_end: float | None = None,
        ax: Axes | None = None,
    ) -> Figure:
        """Running spectrum of a signal over orders: angular frequency over the sliding speed of a contact.

        An order is the number of radians that a signal swings through for each unit of length slid: what is tied to the
        surface (a waviness of the disc) stays at its order while the speed falls, what is tied to the structure (a
        natural frequency) rises to higher orders.

        Parameters
        ----------
        name : str
        contact : str, optional
            Default the first.
        highest : float, optional
            Largest order; default what the sampling shows at the mean speed.
        segment : int, optional
            Samples in each piece of time.
        hz : bool
            Whole swings for each unit of length instead of radians.
        t_start, t_end : float, optional
            Part of the run.
        ax : Axes, optional
        """
        import numpy as np

        from fricmb.analysis import order_map, sliding_speed, spectrogram, uniform
        from fricmb.plot._spectra import draw_orders

        (panel,) = panels(1, ax, title=self._name, height=3.8)
        signal = uniform(self.sol, name, t_start=t_start, t_end=t_end)
        running = spectrogram(signal.x, signal.dt, t_start=float(signal.t[0]), segment=segment)
        edges = np.append(running.t - np.diff(running.t, prepend=0)[-1] / 2, signal.t[-1])
        fine = np.linspace(0, 1, 33)[:-1]
        times = np.clip(edges[:-1, None] + fine * np.diff(edges)[:, None], self.sol.t_start, self.sol.t_end)
        speed = sliding_speed(self.sol, contact or first_contact(self.sol, "orders"), times.ravel())
        mean = speed.reshape(times.shape).mean(axis=1)
        turn = 2.0 * np.pi if hz else 1.0
        top = running.omega[-1] / max(float(mean.mean()), 1e-300) if highest is None else highest * turn
        draw_orders(order_map(running, mean, np.linspace(0.0, top, 400)), name, panel, self.units, hz)
        return figure_of([panel])

    @looked_at
    def animation(
        self,
        path: Any | None = None,
        *,
        t_start: float | None = None,
        t_end: float | None = None,
        frames: int | None = None,
        fps: float = 25.0,
        magnify: float | None = None,
    ) -> Any:
        """The scene as moving pictures: bodies, springs, joints, contact forces with their cones; stick is coloured.

        Mechanisms are drawn to scale; of other scenes displacements are magnified, and what has a contact with two
        tangential directions is seen from above.

        Parameters
        ----------
        path : path, optional
            File to write, ".mp4" (needs ffmpeg), ".gif" or ".html" (the interactive view of :meth:`view`); returned.
            Default: the matplotlib animation itself is returned.
        t_start, t_end : float, optional
            Part of the run; default: a few swings, the last in which the motion is half as large as ever, or all of a
            run without so many.
        frames : int, optional
            Default: 32 for each swing.
        fps : float
            Pictures a second.
        magnify : float, optional
            Drawn displacement per displacement; default: so that the largest fills the drawing.  Bodies that travel far
            are drawn as bands with running strokes.
        """
        from fricmb.plot._animation import animate

        return animate(self.sol, path, t_start=t_start, t_end=t_end, frames=frames, fps=fps, magnify=magnify)

    @looked_at
    def sound(
        self,
        name: str,
        path: Any,
        *,
        seconds: float | None = None,
        speed: float = 1.0,
        t_start: float | None = None,
        t_end: float | None = None,
    ) -> Any:
        """Write a signal as a wav file that lasts ``seconds``, or in which ``speed`` units of time pass each second."""
        from fricmb.plot._sound import write_sound

        span = span_of(self.sol, t_start, t_end)
        return write_sound(self.sol, name, path, seconds=seconds, speed=speed, span=span)

    @looked_at
    def view(self, path: Any, *, t_start: float | None = None, t_end: float | None = None) -> Any:
        """Write an interactive view of the run: one HTML file that needs no network; returns its path.

        The scene in motion with a time slider, any signal over time with stick shaded, any signal over any other, all
        at one time; it follows the reader's light or dark theme.  ``t_start``, ``t_end``: the stretch shown first,
        default a few swings as in :meth:`animation`; the whole run is in the file.
        """
        from pathlib import Path

        from fricmb.plot._view import solution_page

        file = Path(path)
        file.write_text(solution_page(self.sol, t_start=t_start, t_end=t_end), encoding="utf-8")
        return file

    def _unit(self, name: str) -> str:
        return unit_of_signal(self.sol, name, self.units)[1]

    @property
    def _name(self) -> str:
        return str(self.sol.scene.name)
