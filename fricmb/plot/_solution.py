"""Pictures of one solution."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._contact import draw_cone, draw_force_history, draw_modes, draw_phases, zoom
from fricmb.plot._fine import refined
from fricmb.plot._signals import SignalPlots
from fricmb.plot._style import BLUE, DARK, NAMED_CURVES, ORANGE, THIN, figure_of, finish, line, panels, remark

if TYPE_CHECKING:
    from fricmb.solution import Solution


class SolutionPlots(SignalPlots):
    """Pictures of a solution: ``sol.plot.velocities()`` and so on.

    Each method draws a figure of its own, or into ``ax=``, and returns the figure.  Curves are drawn from the dense
    output, so that they are smooth between the solution's times.

    Parameters
    ----------
    sol : Solution
    units : Units, optional
        For the labels; default: those of the solution, which are those of its scene.
    """

    @cached_property
    def curves(self) -> Solution:
        """The solution at the times that are drawn."""
        return refined(self.sol)

    def velocities(self, names: Iterable[str] | None = None, *, ax: Axes | None = None) -> Figure:
        """Velocities over time, a panel for each direction.

        Parameters
        ----------
        names : iterable of str, optional
            Dofs or points; default: all dofs.
        ax : Axes, optional
            Takes all of them.
        """
        wanted = list(self.sol.dof_names if names is None else names)
        groups: dict[str, list[str]] = {}
        for name in wanted:
            groups.setdefault("" if ax is not None else name.rpartition(".")[2], []).append(name)
        axes = panels(max(1, len(groups)), ax, title=self._name, sharex=True)
        for panel, members in zip(axes, groups.values(), strict=False):
            count = len(members)
            for i, name in enumerate(members):
                panel.plot(self.curves.t, self.curves.velocity(name), label=name, **line(i, count))
            finish(panel, x="", y=self._velocity(members), legend=count <= NAMED_CURVES)
            if count > NAMED_CURVES:
                remark(panel, f"{members[0]} (dark) to {members[-1]} (light)")
        axes[-1].set_xlabel(self._time)
        return figure_of(axes)

    def phase(self, name: str, *, ax: Axes | None = None) -> Figure:
        """Phase plane: velocity over position of a dof or point; of a contact, the plane of its relative velocity.

        For a contact in one dimension the friction force is drawn over the relative velocity.
        """
        sol, unit = self.curves, self.units
        is_contact = name in sol.contact_names
        g = sol.relative_velocity(name) if is_contact else sol[name][None]
        (panel,) = panels(1, ax, title=self._name, height=5.0)
        if not is_contact:
            panel.plot(g[0], sol.velocity(name), color=BLUE, linewidth=0.6)
            angle = _is_angle(name)
            x, v = ("rad", unit.angular_velocity) if angle else (unit.length, unit.velocity)
            finish(panel, x=f"{name} [{x}]", y=f"velocity of {name} [{v}]")
        elif len(g) == 2:
            panel.plot(*g, color=BLUE, linewidth=0.6)
            panel.plot(0, 0, "+", color=ORANGE, markersize=9, markeredgewidth=1.5, label="stick")
            first, second = sol.names.axes(name)
            finish(
                panel,
                x=f"relative velocity along {first} at {name} [{unit.velocity}]",
                y=f"along {second} [{unit.velocity}]",
                legend=True,
            )
        else:
            panel.plot(g[0], sol.force(name)[0], color=BLUE, linewidth=THIN)
            finish(panel, x=f"relative velocity at {name} [{unit.velocity}]", y=f"friction force [{unit.force}]")
        return figure_of([panel])

    def force(self, contact: str, *, ax: Axes | None = None) -> Figure:
        """Friction force of a contact with its cone: over time, and in its plane if there are two directions.

        The plane is drawn twice: the whole cone, and enlarged where the force was.  With ``ax`` the whole cone alone.
        """
        sol = self.curves
        planar = len(sol.force(contact)) == 2
        if ax is not None:
            (draw_cone if planar else draw_force_history)(sol, contact, ax, self.units)
            return figure_of([ax])
        if not planar:
            axes = panels(1, None, title=self._name, height=3.2)
            draw_force_history(sol, contact, axes[0], self.units)
            return figure_of(axes)
        import matplotlib.pyplot as plt

        figure, named = plt.subplot_mosaic(
            [["time", "time"], ["plane", "close"]], figsize=(7.0, 6.0), layout="constrained", height_ratios=[1, 1.3]
        )
        named["time"].set_title(self._name, loc="left", fontsize="medium")
        draw_force_history(sol, contact, named["time"], self.units)
        draw_cone(sol, contact, named["plane"], self.units)
        zoom(sol, contact, named["close"], self.units)
        return figure

    def transitions(self, *, ax: Axes | None = None) -> Figure:
        """When each contact sticks, slips or is open, and how long each of these phases lasts.

        With ``ax`` the first alone.
        """
        height = 3.2 + min(0.35 * len(self.sol.contact_names), 6.0)
        axes = panels(2, ax, title=self._name, height=height, sharex=True)
        draw_modes(self.sol, axes[0])
        if ax is None:
            draw_phases(self.sol, axes[1], self.units)
        axes[-1].set_xlabel(self._time)
        return figure_of(axes)

    def energy(self, *, ax: Axes | None = None) -> Figure:
        """Where the energy is and where it went; the ledger's residual below, unless ``ax`` is given."""
        energy, t = self.curves.energy, self.curves.t
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
            axes[1].plot(t, energy.residual, color=DARK, linewidth=0.7)
            finish(axes[1], x="", y="residual, relative")
        axes[-1].set_xlabel(self._time)
        return figure_of(axes)

    def _velocity(self, names: list[str]) -> str:
        """Label of an axis that the velocities of these share."""
        if all(map(_is_angle, names)):
            return f"angular velocity [{self.units.angular_velocity}]"
        return f"velocity [{self.units.velocity}]"

    @property
    def _time(self) -> str:
        return f"time [{self.units.time}]"


def _is_angle(name: str) -> bool:
    """Whether a dof or a relative motion is a rotation."""
    return name.endswith(".angle")
