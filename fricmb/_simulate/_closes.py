"""Whether the energy ledger of a run closes: the check that every integrator's result goes through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.trajectory import MotionSamples
from fricmb.solution import Solution
from fricmb.solution._run import Record

#: What may be missing of the energy that is exchanged in a run (a large stored energy that stays is none): in units of
#: rtol, at least, and for fixed steps, whose error nobody has asked for.
PARTS, LEAST, FIXED = 100.0, 1e-8, 3e-4
#: Round-off of sums of energies.
ROUND_OFF = 1e-14
#: Relative error of a position that is added up over a run.
DIGITS = 1e-15
#: Times at which it is looked at.
TIMES = 33


def ledger_note(sol: Solution, rtol: float | None) -> tuple[str, ...]:
    """A sentence for ``stats.notes`` where the ledger does not close; ``rtol`` None: fixed steps.

    Energy, losses and input are integrated along with the motion and apart from it: what is missing is an error of the
    run that no error estimate of its steps has seen.  The reverse does not hold.
    """
    lost, scale = unclosed(sol)
    if lost <= (FIXED if rtol is None else max(PARTS * rtol, LEAST)) * scale:
        return ()
    asked = "too large a step" if rtol is None else f"rtol = {rtol:g} is not reached"
    return (f"the energy ledger does not close: {lost / scale:.1e} of the exchanged energy is missing ({asked}?)",)


def unclosed(sol: Solution) -> tuple[float, float]:
    """Energy that is missing, beyond its round-off, and the energy that is exchanged in the run.

    What all but rests exchanges nothing; there the energy is taken that friction would bring in one step if nothing
    held against it: what a step resolves in forces, it resolves in that.
    """
    record = sol.record
    n = record.samples.t.size
    if n < 2:
        return 0.0, 0.0
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
    if lost > LEAST * scale:  # what costs a look is looked at where it may matter
        lost -= max(_grain(sol, view) for view in views)
        scale = max(scale, _of_a_step(sol, views[0]))
    return max(lost, 0.0), scale


def _grain(sol: Solution, chosen: slice) -> float:
    """Round-off of the stored energy: what the last digits of the positions make of it.

    Far from the origin it is a small difference of large terms.
    """
    samples, piece = _part(sol, chosen)
    signs = np.random.default_rng(0).choice((-1.0, 1.0), size=samples.q.shape)
    shaken = replace(samples, q=samples.q * (1.0 + DIGITS * signs))
    moving = sol.record.moving
    energies = [sol.run.energies(Record(samples=these, piece=piece, moving=moving))[1] for these in (samples, shaken)]
    return float(np.abs(energies[1] - energies[0]).max(initial=0.0))


def _of_a_step(sol: Solution, chosen: slice) -> float:
    """Kinetic energy that the largest friction of the run would give all masses together in one step."""
    samples, piece = _part(sol, chosen)
    F = float(np.abs(samples.F).max(initial=0.0))
    still = replace(samples, v=np.ones_like(samples.v))
    mass = 2.0 * float(sol.run.energies(Record(samples=still, piece=piece))[0].max(initial=0.0))
    h = (sol.t_end - sol.t_start) / max(1, sol.stats.n_steps or sol.t.size - 1)
    return 0.5 * (F * h) ** 2 / mass if mass > 0.0 else 0.0


def _part(sol: Solution, chosen: slice) -> tuple[MotionSamples, Ints | None]:
    record = sol.record
    return take(record.samples, chosen), None if record.piece is None else record.piece[chosen]


def _terms(sol: Solution, chosen: slice) -> tuple[Floats, ...]:
    """Kinetic and potential energy, losses by friction and damping, and input, at some of the times."""
    samples, piece = _part(sol, chosen)
    kinetic, potential = sol.run.energies(Record(samples=samples, piece=piece, moving=sol.record.moving))
    spent = take(sol.accounts, chosen)
    return kinetic, potential, spent.friction_loss.sum(axis=0), spent.damping_loss, spent.input
