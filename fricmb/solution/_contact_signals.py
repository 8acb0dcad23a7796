"""What a solution tells of its contacts and joints."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import FricmbError, shown
from fricmb.integrate import Samples
from fricmb.integrate.problem import Codes, Floats, Ints
from fricmb.solution._ledger import Ledger
from fricmb.solution._recorded import row_of
from fricmb.values import is_plain


class ContactSignals(Ledger):
    """Forces, modes and states of contacts, reactions of joints, shares of time."""

    def force(self, contact: str) -> Floats:
        """Friction force on the contact's first end (d, n_t)."""
        force = self._rows_of(self.record.samples.F, contact, 1)
        if self.names.row_offset is None:
            return force
        k, row = self.names.contact(contact), self.names.row
        return force - self.names.row_offset[row[k] : row[k + 1]] * self.normal_force(contact)

    def relative_velocity(self, contact: str) -> Floats:
        """Velocity of the first end relative to the second, with the slide (d, n_t)."""
        return self._rows_of(self.record.samples.g, contact, -1)

    def normal_force(self, contact: str) -> Floats:
        """Normal force (n_t,), at least 0."""
        return row_of(self.record.samples.N, self.names.contact(contact))

    def mode(self, contact: str) -> Codes:
        """0 stick, 1 slip, 2 open (n_t,), int8."""
        codes: Codes = self.record.samples.mode[self.names.contact(contact)]
        return codes

    def state(self, contact: str) -> Floats:
        """Internal states of the contact's law (n_states, n_t); no rows for a law without."""
        k, start = self.names.contact(contact), self.names.z_start
        return self.record.samples.z[start[k] : start[k + 1]]

    def reaction(self, joint: str) -> Floats:
        """Reaction of a joint on its first end (rows, n_t): forces and torques in the order the joint's type says.

        Where constraints depend on one another, the reactions of least norm.
        """
        return self.run.reaction(joint, self.record)

    def _rows_of(self, values: Floats, contact: str, power: int) -> Floats:
        k, row = self.names.contact(contact), self.names.row
        own = slice(row[k], row[k + 1])
        scale = self.names.row_scale[own]
        return values[own] if np.all(scale == 1.0) else values[own] * scale**power

    def time_share(self, contact: str, mode: int) -> float:
        """Share of the run that a contact spends in a mode (0 stick, 1 slip, 2 open), from the accepted steps."""
        return float(self.time_shares(mode)[self.names.contact(contact)])

    def time_shares(self, mode: int) -> Floats:
        """The same of every contact (n_contacts,)."""
        if not (is_plain(mode) and mode in (0, 1, 2)):
            raise FricmbError(f"mode: got {shown(mode)}; expected 0 (stick), 1 (slip) or 2 (open)")
        modes, spans = self._rows_of_modes
        if not spans.any():
            return np.zeros(len(self.names.contacts))
        return np.asarray((modes == mode) @ spans / spans.sum(), dtype=float)

    def rest_spans(self, contact: str) -> Floats:
        """Stretches (n, 2) in which a contact is at rest without sticking, from the accepted steps.

        Joints of a mechanism that others hold are at rest in this way: those that stick are enough to stop them all.
        """
        t, rests = self._resting
        mine = rests[self.names.contact(contact)]
        return np.column_stack((t[:-1][mine], t[1:][mine]))

    def rest_share(self, contact: str) -> float:
        """Share of the run that a contact is at rest without sticking."""
        length = self.t_end - self.t_start
        return float(np.diff(self.rest_spans(contact)).sum() / length) if length > 0.0 else 0.0

    @cached_property
    def _rows_of_modes(self) -> tuple[Codes, Floats]:
        samples = (self.record if self.has_rows else self.run.row_motion()).samples
        return samples.mode[:, :-1], np.diff(samples.t)

    @cached_property
    def _resting(self) -> tuple[Floats, NDArray[np.bool_]]:
        samples = self.accounts if self.has_rows else self.run.rows().samples
        return samples.t, resting(samples, self.names.row)


#: A relative velocity below this share of the contact's largest is none: rest, not a passage through 0.
STILL = 1e-10
#: The mode of a contact that slips, and as what one at rest counts that does not stick.
_SLIP = 1


def resting(samples: Samples, row: Ints) -> NDArray[np.bool_]:
    """Which contacts (n_c,) neither stick nor move between which accepted steps (n_t - 1,); ``row``: first rows."""
    speed = np.sqrt(np.add.reduceat(samples.g**2, row[:-1], axis=0)) if len(row) > 1 else np.zeros(samples.mode.shape)
    still = (speed <= STILL * speed.max(axis=1, initial=0.0, keepdims=True)) & (samples.mode == _SLIP)
    loss = samples.friction_loss
    # else it moved in between, from one reversal to the next
    quiet = np.diff(loss) <= STILL * loss.max(axis=1, initial=0.0, keepdims=True)
    found: NDArray[np.bool_] = still[:, :-1] & still[:, 1:] & quiet & (np.diff(samples.t) > 0.0)
    return found
