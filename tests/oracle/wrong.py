"""Runs that are wrong by a known amount, and from which amount on an audit says so.

Each way makes a run of another scene, or of changed values, and audits it against the scene that it is not a run of.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import sympy

import fricmb as fm
from fricmb.audit import Audit
from fricmb.integrate.event_kinds import EVENT_KINDS
from fricmb.integrate.trajectory import SampledTrajectory, Transitions

RTOL = 1e-6
#: Amounts that are tried, from the smallest on.
LADDER = tuple(float(f"{x:.0e}") for x in 10.0 ** np.arange(-7.0, -0.9, 0.5))
Change = Callable[[Any], Any]


class Changed(SampledTrajectory):
    """A run of which the values are changed before anybody sees them."""

    def __init__(self, held: Any, change: Change, transitions: Any = None) -> None:
        self.held, self.change = held, change
        events = held.transitions if transitions is None else transitions
        super().__init__(held.problem, change(held.rows()), events, held.counters, held.end, held.failure)

    def sample(self, t: Any) -> Any:
        """Dense output."""
        return self.change(self.held.sample(t))


def changed(sol: Any, change: Change, events: Any = None) -> Audit:
    """The audit of a run with other values."""
    (piece,) = sol.run.pieces
    piece._trajectory = Changed(piece.trajectory, change, events)
    if events is not None:
        sol._events = None  # made again from those
    return sol.audit()


def against(wrong: Any, right: Any) -> Audit:
    """A run of one scene, audited by the statements of another with the same parts."""
    (piece,), (other,) = wrong.run.pieces, right.run.pieces
    piece._mechanics = other.mechanics
    return wrong.audit()


def run(scene: Any, t_end: float = 20.0) -> Any:
    """By the general method."""
    return fm.simulate(scene, t_end=t_end, rtol=RTOL, method="radau")


def block(law: Any, *, belt: float | None = None, load: Any = None, N: Any = 1.0) -> Any:
    """A mass on a spring, on the ground or a belt."""
    mass = fm.Body("block", mass=1.0)
    parts = [mass, fm.Spring("spring", mass, axis="x", stiffness=1.0)]
    under = fm.Driven("belt", velocity={"x": belt}) if belt is not None else fm.GROUND
    parts += [under] if belt is not None else []
    parts.append(fm.Contact("sole", mass, under, law=law, normal_force=N))
    if load is not None:
        parts.append(fm.Force("push", mass, axis="x", value=load))
    return fm.Scene("block", parts)


def coulomb(mu_s: float = 1.5, mu_k: float = 1.0) -> Any:
    """Set-valued."""
    return fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)


def break_away(size: float) -> Audit:
    """Static friction larger by that share: break-away comes late, everything after it is consistent."""
    return against(run(block(coulomb(1.5 * (1.0 + size)), belt=0.1)), run(block(coulomb(), belt=0.1)))


def excursion(size: float) -> Audit:
    """A peak of the load that share above the limit, for which the block should have slipped a little, is missed."""
    peak = 0.7 + 0.1 * (1.0 + 8.0 * size) * sympy.exp(-((fm.t - 5) ** 2) / 0.01)
    held = block(coulomb(0.8 * (1.0 + 2.0 * size), 0.6), load=peak)
    return against(run(held), run(block(coulomb(0.8, 0.6), load=peak)))


def phantom(size: float) -> Audit:
    """Said to slip for six seconds, without motion, under a load that share below what would be held."""
    sol = run(block(coulomb(0.8, 0.8), load=0.8 * (1.0 - size)))
    kinds = [EVENT_KINDS.index(kind) for kind in ("slip", "stick")]
    between = Transitions(t=np.array([5.0, 11.0]), contact=np.zeros(2, np.int64), kind=np.array(kinds))

    def slips(samples: Any) -> Any:
        mode = np.where((samples.t > 5.0) & (samples.t < 11.0), 1, samples.mode).astype(np.int8)
        return dataclasses.replace(samples, mode=mode)

    return changed(sol, slips, between)


def creep(size: float) -> Audit:
    """Stick that creeps with that share of the largest speed."""
    sol = run(block(coulomb(), belt=0.1))
    top = float(np.abs(sol.v).max())

    def creeps(samples: Any) -> Any:
        more = size * top * (samples.mode == 0)
        return dataclasses.replace(samples, v=samples.v + more, g=samples.g + more)

    return changed(sol, creeps)


def direction(size: float) -> Audit:
    """Friction of a sliding disc turned by that angle."""
    disc = fm.Body("disc", mass=1.0, axes="xy", velocity={"x": 1.0, "y": 0.3})
    springs = [fm.Spring(f"k{a}", disc, axis=a, stiffness=k) for a, k in (("x", 4.0), ("y", 6.0))]
    rubs = fm.Contact("sole", disc, law=coulomb(0.1, 0.1), normal_force=1.0, axes="xy")
    sol = run(fm.Scene("disc", [disc, *springs, rubs]), 3.0)
    turn = np.array([[np.cos(size), -np.sin(size)], [np.sin(size), np.cos(size)]])
    return changed(sol, lambda samples: dataclasses.replace(samples, F=turn @ samples.F))


def instant(size: float) -> Audit:
    """From the first break-away on everything happens that share of the run later."""
    sol = run(block(coulomb(), belt=0.1))
    held, t0 = sol.run.pieces[0].trajectory, float(sol.events.t[1])

    def late(samples: Any) -> Any:
        shift = np.minimum(np.maximum(samples.t - t0, 0.0), size * 20.0)
        return dataclasses.replace(held.sample(samples.t - shift), t=samples.t)

    return changed(sol, late)


WAYS: dict[str, Callable[[float], Audit]] = {
    "break-away late, static friction off by": break_away,
    "an excursion missed, load above the limit by": excursion,
    "slip said where it rests, load below the limit by": phantom,
    "creep in stick, of the largest speed": creep,
    "force turned by (rad)": direction,
    "everything late, of the run": instant,
}


def smallest(way: Callable[[float], Audit]) -> tuple[float | None, str, float]:
    """The smallest amount from which on every larger one fails its audit, by which check, of which size there."""
    found: tuple[float | None, str, float] = (None, "", 0.0)
    for size in reversed(LADDER):
        audit = way(size)
        if audit.ok:
            break
        found = (size, audit.failed[0].name, audit.failed[0].size)
    return found
