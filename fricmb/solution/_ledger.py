"""The energies of a solution."""

from __future__ import annotations

from functools import cached_property

from fricmb.integrate.problem import Floats
from fricmb.solution._energy import Energy, Reference
from fricmb.solution._recorded import Recorded
from fricmb.solution._run import Record


class Ledger(Recorded):
    """Kinetic and potential energy, losses and input."""

    @cached_property
    def energy(self) -> Energy:
        """The energy ledger at the solution's times."""
        return self._ledger(self.record, None if self.has_rows else self._reference, self._energies)

    def _ledger(
        self, record: Record, reference: Reference | None, energies: tuple[Floats, Floats] | None = None
    ) -> Energy:
        kinetic, potential = self.run.energies(record) if energies is None else energies
        samples = record.samples
        return Energy(
            kinetic=kinetic,
            potential=potential,
            friction_loss_by_contact=samples.friction_loss,
            damping_loss=samples.damping_loss,
            input=samples.input,
            contacts=self.names.contacts,
            reference=reference,
        )

    @cached_property
    def _reference(self) -> Reference:
        if self.has_rows:
            return self.energy.reference
        return self._ledger(self.run.rows(), None).reference
