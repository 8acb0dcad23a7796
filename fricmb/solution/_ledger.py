"""The energies of a solution."""

from __future__ import annotations

from functools import cached_property

from fricmb.integrate import Samples
from fricmb.integrate.problem import Floats
from fricmb.solution._differentiated import Differentiated
from fricmb.solution._energy import Energy, Reference
from fricmb.solution._impacts import with_impacts
from fricmb.solution._recorded import finite
from fricmb.solution._run import Record


class Ledger(Differentiated):
    """Kinetic and potential energy, losses and input; integrated from the dense output when they are asked for."""

    @cached_property
    def energy(self) -> Energy:
        """The energy ledger at the solution's times.

        Raises
        ------
        IntegrationError
            If an energy is too large for a floating-point number.
        """
        energies = self.run.energies(self.record) if self._energies is None else self._energies
        found = self._ledger(energies, self.accounts, None if self.has_rows else self._reference)
        return with_impacts(found, self.events, self.t, self.t_start, rows=self.has_rows)

    @cached_property
    def accounts(self) -> Samples:
        """What the run says at the solution's times, energies since its start included."""
        here = self.record.samples
        if isinstance(here, Samples):
            return here
        run = self.run
        found = finite(run.rows() if self.has_rows else run.sample(here.t)).samples
        return here.with_energies(
            friction_loss=found.friction_loss, damping_loss=found.damping_loss, input=found.input
        )

    def _ledger(self, energies: tuple[Floats, Floats], samples: Samples, reference: Reference | None) -> Energy:
        kinetic, potential = energies
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
        run = self.run
        if run.reference is None:  # of all solutions that see the run at other times
            rows: Record[Samples] = run.rows()
            run.reference = self._ledger(run.energies(rows), rows.samples, None).reference
        return run.reference
