"""Whether the energy ledger of a run closes: the check that every integrator's result goes through."""

from __future__ import annotations

import numpy as np

from fricmb.integrate._long import take
from fricmb.integrate._problem import Floats
from fricmb.solution import Solution
from fricmb.solution._run import Record

#: What may be missing of the energy that is exchanged in a run (a large stored energy that stays is none): in units of
#: rtol, at least, and for fixed steps, whose error nobody has asked for.
PARTS, LEAST, FIXED = 100.0, 1e-8, 3e-4
#: Round-off of sums of energies.
ROUND_OFF = 1e-14
#: Times at which it is looked at.
TIMES = 33


def ledger_note(sol: Solution, rtol: float | None) -> tuple[str, ...]:
    """A sentence for ``stats.notes`` where the ledger does not close; ``rtol`` None: fixed steps.

    Energy, losses and input are integrated along with the motion and apart from it: what is missing is an error of the
    run that no error estimate of its steps has seen.  The reverse does not hold.
    """
    record = sol.record
    n = record.samples.t.size
    if n < 2:
        return ()
    stride = -(-(n - 1) // (TIMES - 1))
    # views: of a large scene no second copy is made
    views = [slice(0, n, stride)] + ([slice(n - 1, n)] if (n - 1) % stride else [])
    parts = [_terms(sol, view) for view in views]
    kinetic, potential, friction, damping, brought = (np.concatenate(term) for term in zip(*parts, strict=True))
    missing = kinetic + potential + friction + damping - brought
    terms = (potential, friction, damping, brought)
    scale = max(float(kinetic.max()), *(float(np.abs(term - term[0]).max()) for term in terms))
    grain = ROUND_OFF * max(float(np.abs(term).max()) for term in (kinetic, *terms))
    lost = float(np.abs(missing - missing[0]).max()) - grain
    if lost <= (FIXED if rtol is None else max(PARTS * rtol, LEAST)) * scale:
        return ()
    asked = "too large a step" if rtol is None else f"rtol = {rtol:g} is not reached"
    return (f"the energy ledger does not close: {lost / scale:.1e} of what is exchanged is missing ({asked}?)",)


def _terms(sol: Solution, chosen: slice) -> tuple[Floats, ...]:
    """Kinetic and potential energy, losses by friction and damping, and input, at some of the times."""
    record = sol.record
    samples = take(record.samples, chosen)
    piece = None if record.piece is None else record.piece[chosen]
    kinetic, potential = sol.run.energies(Record(samples=samples, piece=piece, moving=record.moving))
    return kinetic, potential, samples.friction_loss.sum(axis=0), samples.damping_loss, samples.input
