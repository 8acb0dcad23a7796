"""When steps of Newton's method are taken, and when it ends; the same in the band and condensed (see _cones)."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.timestepping._run import Run

#: Most Newton steps, and halvings of one.
NEWTON, HALVINGS = 60, 40
#: Full Newton steps in a row that may raise the merit.
LEAPS = 6
#: Relative size of a Newton step after which no further one is taken.
ENOUGH = 1e-7


@kernel
def falls(merit: float, low: float) -> bool:
    """Whether the merit is lower, up to its round-off."""
    return bool(merit <= low + 1e-11 * abs(low))


@kernel
def leaps_pay(run: Run) -> bool:
    """Whether full steps that raise the merit are worth it: friction along one direction is linear piece by piece.

    In two directions a full step of slip overshoots to the other side of the disc, and the next one back.
    """
    return bool(run.P.shape[0] == run.status.shape[0])
