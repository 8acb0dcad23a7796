"""The energy ledger of a run."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fricmb.integrate.problem import Floats


@dataclass(frozen=True)
class Reference:
    """What the residual is measured against: total energy at the start, and the largest term of the run."""

    start: float
    largest: float


class Energy:
    """Where the energy is, and where it went.

    Attributes
    ----------
    kinetic, potential : (n_t,)
        Kinetic and stored energy: of springs, modes, pressed contacts, and weight (``Gravity``).
    friction_loss_by_contact : (n_contacts, n_t)
        Energy lost to friction since the start of the run, in the order of ``contacts``.
    damping_loss, input : (n_t,)
        Energy lost to damping, and brought in by forces and torques of the scene (constant ones as well), driven bodies
        and slides, since the start.
    impact_loss : (n_t,)
        Energy lost in impacts since the start, by friction in them as well.
    contacts : tuple of str
    """

    def __init__(
        self,
        *,
        kinetic: Floats,
        potential: Floats,
        friction_loss_by_contact: Floats,
        damping_loss: Floats,
        input: Floats,
        contacts: tuple[str, ...],
        impact_loss: Floats | None = None,
        reference: Reference | None = None,
    ) -> None:
        self.kinetic = kinetic
        self.potential = potential
        self.friction_loss_by_contact = friction_loss_by_contact
        self.damping_loss = damping_loss
        self.impact_loss = np.zeros_like(damping_loss) if impact_loss is None else impact_loss
        self.input = input
        self.contacts = contacts
        self._reference = reference

    @cached_property
    def friction_loss(self) -> Floats:
        """Energy lost to friction since the start, all contacts together (n_t,)."""
        loss: Floats = self.friction_loss_by_contact.sum(axis=0)
        return loss

    @property
    def total(self) -> Floats:
        """Kinetic and potential energy together (n_t,)."""
        return self.kinetic + self.potential

    @cached_property
    def reference(self) -> Reference:
        """Start and scale of the ledger; of these times themselves where no other was given."""
        if self._reference is not None:
            return self._reference
        terms = (
            self.kinetic, self.potential, self.friction_loss, self.damping_loss, self.impact_loss, self.input,
        )  # fmt: skip
        largest = max((float(np.abs(term).max()) for term in terms if term.size), default=0.0)
        return Reference(float(self.total[0]) if self.kinetic.size else 0.0, largest)

    @cached_property
    def residual(self) -> Floats:
        """What the ledger does not account for, relative to the largest term of the run (0 where all are 0); (n_t,).

        ``kinetic + potential + friction_loss + damping_loss + impact_loss - input``, less its value at the start.
        """
        if self.reference.largest == 0.0:
            return np.zeros_like(self.kinetic)
        lost = self.friction_loss + self.damping_loss + self.impact_loss
        missing = self.total + lost - self.input - self.reference.start
        residual: Floats = missing / self.reference.largest
        return residual

    def __repr__(self) -> str:
        if not self.kinetic.size:
            return "<energy: no times>"
        return (
            f"<energy: {self.reference.start:.6g} at the start, {self.total[-1]:.6g} at the end; friction "
            f"{self.friction_loss[-1]:.6g}, damping {self.damping_loss[-1]:.6g}, "
            f"{f'impacts {self.impact_loss[-1]:.6g}, ' if self.impact_loss[-1] else ''}input {self.input[-1]:.6g}; "
            f"residual {np.abs(self.residual).max():.1e}>"
        )
