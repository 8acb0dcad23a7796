"""When steps of Newton's method are taken, and when it ends; in the band and condensed (see proximal_newton)."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.timestepping.room import Run

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
def judge_step(
    merit: float, low: float, size: float, scale: float, wary: bool, flat_steps: int, leaps: int
) -> tuple[bool, int, int]:
    """Whether a Newton step was the last, and how many in a row have left the merit as it was, and have raised it.

    A full step of size ENOUGH leaves its square; the merit cannot tell smaller ones from round-off.
    """
    if not (wary or falls(merit, low)):
        return False, flat_steps, leaps + 1
    flat_steps = flat_steps + 1 if merit > low - 1e-11 * abs(low) else 0
    return size <= ENOUGH * (scale + size) + 1e-300 or flat_steps == 4, flat_steps, 0


@kernel
def leaps_pay(run: Run) -> bool:
    """Whether full steps that raise the merit are worth it: friction along one direction is linear piece by piece.

    In two directions a full step of slip overshoots to the other side of the disc, and the next one back.
    """
    return bool(run.P.shape[0] == run.status.shape[0])
