"""Impulses of impacts, and the energy that they took."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.errors import unknown_name
from fricmb.integrate.problem import Floats
from fricmb.integrate.trajectory import IMPACT_COLUMNS
from fricmb.solution._energy import Energy
from fricmb.solution._events import Events


@dataclass(frozen=True, kw_only=True)
class Impulses:
    """Impulses of one part, in time order.

    Attributes
    ----------
    t, normal, tangential : (n,)
        Times; impulses along the normal, >= 0, and along slip, on the part's first end.
    side : tuple of str
        Of a part with two ends "lower" or "upper", else "".
    """

    t: Floats
    normal: Floats
    tangential: Floats
    side: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.t)


def impulses(events: Events, name: str, known: tuple[str, ...]) -> Impulses:
    """See :meth:`fricmb.Solution.impulse`."""
    if name not in known:
        raise unknown_name("part with impacts", name, known)
    mine = list(events.of(kind="impact", contact=name))
    return Impulses(
        t=np.array([event.t for event in mine]),
        normal=np.array([event.impulse for event in mine]),
        tangential=np.array([event.tangential_impulse for event in mine]),
        side=tuple(event.side for event in mine),
    )


def with_impacts(energy: Energy, events: Events, t: Floats, t_start: float, *, rows: bool) -> Energy:
    """The ledger with what impacts took told apart from damping; ``rows``: a time that is there twice is before first.

    Impacts at the start of the run are before it.

    The loss of a run's damping holds that of impacts as well.
    """
    impacts = events.impacts
    if not len(impacts):
        return energy
    order = np.argsort(impacts[:, 0], kind="stable")
    lost = np.append(0.0, np.cumsum(impacts[order, IMPACT_COLUMNS.index("loss")]))
    times = impacts[order, 0]
    passed = np.searchsorted(times, t, side="right")
    if rows:
        first = np.append(t[:-1] == t[1:], False)
        passed = np.where(first, np.searchsorted(times, t, side="left"), passed)
    loss = np.maximum(lost[passed] - lost[np.searchsorted(times, t_start, side="right")], 0.0)
    return Energy(
        kinetic=energy.kinetic, potential=energy.potential, friction_loss_by_contact=energy.friction_loss_by_contact,
        damping_loss=energy.damping_loss - loss, input=energy.input, contacts=energy.contacts, impact_loss=loss,
        reference=energy._reference,
    )  # fmt: skip
