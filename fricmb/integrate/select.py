"""The choice of ``method="auto"``; an integrator is loaded where it is chosen."""

from __future__ import annotations

import math

import numpy as np

from fricmb.integrate.collocation.exact_room import free_blocks
from fricmb.integrate.collocation.one_contact.prepare import is_single
from fricmb.integrate.collocation.structure_blocks import NoBlocks
from fricmb.integrate.collocation.suits import FRICTION_ROWS, against, port_rows, too_far_apart
from fricmb.integrate.guard import Guarded
from fricmb.integrate.integrator import Integrator
from fricmb.integrate.methods.bdf import Bdf
from fricmb.integrate.methods.free_vibration import Exact
from fricmb.integrate.methods.radau import Radau
from fricmb.integrate.model.problem_structs import packed_of
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, Floats, Problem
from fricmb.integrate.suits_taylor import against_taylor, fastest

#: Degrees of freedom from which on banded steps are faster than exact structure (measured with uncoupled modes).
WIDE = 100
#: Degrees of freedom up to which one contact under constant friction is best left to kernels of its own, which keep
#: some twenty matrices of that size, unless the structure is a narrow band.  In all, with what is made ready before: a
#: bar of 200, 400 and 1000 modes 0.1, 0.5 and 4 s, by Taylor steps 0.9, 3 s and more than a minute; a dense structure
#: of 200 degrees of freedom 0.2 s and 8 s; 200 masses in a row 0.06 and 0.04 s.
FULL_MATRICES = 1600

#: Degrees of freedom to a contact up to which Taylor steps are faster than exact structure where contacts are coupled
#: or friction depends on slip speed: on two to fifty contacts under Stribeck laws, and on stacks, bdf took 1.3 to 2
#: times as long as Taylor steps with two contacts, 2 to 4 times with four, 10 times with sixteen, 25 with fifty;
#: collocation 1.3 to 2.2 times with two and three.
DEEP = 5
#: Beyond, and with one contact, the highest frequency sets the steps of both, which cost n in the one and n squared in
#: the other; what does not ring the other passes over.  Taylor steps are faster up to CLOSE n between the highest and
#: the lowest frequency, n up to FULL, and SPREAD n (docs/decisions/0081-taylor-steps-for-one-contact.md).
CLOSE, FULL, SPREAD = 32.0, 30, 8.0
#: Damping ratio below which fast modes go on ringing and move what friction depends on: so many times farther apart
#: exact structure, whose polynomials must follow them as well, needs longer to the same error.
CLEAR, UNDAMPED = 0.005, 32.0
#: Part of the contact's mobility that a mode must have for the contact to feel it: a heavy rotor that hangs on a soft
#: spring makes no spread of frequencies.
FELT = 0.01
#: Contacts below which steps that end where a law bends are faster than Taylor steps.
FEW = 4
#: Damping ratio of a mode that is calm before a slower one has moved, and how many times as fast it is where explicit
#: steps begin to lose: two blocks on a belt tied by k = 1e4 and 1e6 with a damping ratio of 0.35 took Taylor steps 2
#: and 40 times as long as bdf.
CALM, APART = 0.1, 100.0
#: Beside such modes, the tolerance down to which exact structure is right, and the damping ratio from which on they
#: creep back to rest.
BEARS_CALM_MODES, CREEPS = 1e-6, 0.99


def is_banded(problem: Problem) -> bool:
    """Whether implicit steps keep banded factors."""
    return int(packed_of(problem).structure.half) >= 0


def choose(problem: Problem, rtol: float = 1e-6) -> tuple[Integrator, str]:
    """The integrator for a problem at a tolerance, and why: the fastest that takes it, else the general one."""
    return once_per(problem, ("choice", rtol), lambda: _choose(problem, rtol))


def _choose(problem: Problem, rtol: float) -> tuple[Integrator, str]:
    if problem.mechanism is not None:
        return Radau(), "bodies that turn or joints: one-step on the index-reduced system"
    exact = Exact()
    if exact.refuses(problem) is None:
        return exact, "free vibration of a linear structure: closed form"
    if _in_blocks(problem) and (single := _one_contact(problem, rtol)) is not None:
        return single
    if (few := _few_on_modes(problem, rtol)) is not None:
        return few
    if (series := _taylor_where_fastest(problem)) is not None:
        return series
    contact_rows = problem.m + problem.n_v
    if problem.n >= WIDE and contact_rows > 0 and is_banded(problem):
        why = f"{problem.n} degrees of freedom in a narrow band, {contact_rows} rows of contacts"
        return Bdf(), f"{why}: the general method, transitions located"
    if (single := _one_contact(problem, rtol)) is not None:
        return single
    # whether its structure has blocks takes an eigenproblem: asked where the sizes allow it alone
    reason = against(problem, rtol) or _against_exact(problem, rtol)
    if reason is None:
        rows = port_rows(problem)
        return Guarded(), f"linear structure with few port rows ({rows}): exact structure, unknowns at the ports"
    general = Radau() if np.any(problem.contacts.law == LAW_SMOOTH) else Bdf()
    return general, f"the general method: {reason}"


def _in_blocks(problem: Problem) -> bool:
    """Whether exact structure is cheap: of few degrees of freedom, or given by modes, or coupled as a whole anyway."""
    few = problem.n < WIDE
    return few or (problem.n <= FULL_MATRICES and is_single(problem) and packed_of(problem).structure.half <= 0)


def _one_contact(problem: Problem, rtol: float) -> tuple[Integrator, str] | None:
    """The kernels for one contact under constant friction and why, where they take the problem."""
    if not is_single(problem) or _against_exact(problem, rtol) is not None:
        return None
    why = "linear structure with one contact under constant friction: exact structure, unknowns at the port"
    return Guarded(), why


def _few_on_modes(problem: Problem, rtol: float) -> tuple[Integrator, str] | None:
    """Collocation and why, where few contacts under constant friction rub on a body given by many modes."""
    contacts, rows = problem.contacts, port_rows(problem)
    if not (problem.n_c > 1 and FULL <= problem.n <= FULL_MATRICES and rows == problem.m <= FRICTION_ROWS):
        return None
    if (contacts.law != LAW_CONSTANT).any() or not _is_modal(problem):
        return None
    if _against_exact(problem, rtol) is not None:
        return None
    why = "exact structure, whose steps cost no more than there are modes"
    return Guarded(), f"{problem.n_c} contacts on {problem.n} modes: {why}"


def _is_modal(problem: Problem) -> bool:
    """Whether nothing couples the degrees of freedom but contacts."""
    inside = slice(0, problem.n), slice(0, problem.n)
    parts = [problem.linear.csr(name) for name in ("M", "Kx", "Cx")]
    return all(part.block(*inside).is_diagonal() for part in parts)


def _taylor_where_fastest(problem: Problem) -> tuple[Integrator, str] | None:
    """Taylor steps and why, where they are the fastest."""
    if problem.n_c == 0 or (problem.n < WIDE and is_single(problem)):
        return None
    if problem.contacts.knots.size and problem.n_c < FEW:
        return None  # steps that end where a law bends take half the time and know of every bend that a law states
    # asked first of all, since Taylor steps are slow to load
    shallow = problem.n < DEEP * problem.n_c
    if against_taylor(problem) is not None:
        return None
    if problem.n_c == 1 and not _are_close(problem):
        return None
    from fricmb.integrate.guarded_taylor import GuardedTaylor
    from fricmb.integrate.taylor.prepare_groups import coupled_or_rate_dependent

    contacts = f"{problem.n_c} contacts" if problem.n_c > 1 else "one contact"
    many = GuardedTaylor()
    if many.refuses(problem) is not None or (problem.n_c < FEW and _held_by_calm_modes(problem)):
        return None
    if problem.n_c > 1 and not coupled_or_rate_dependent(problem):
        return many, f"{contacts} under constant friction, none sharing a body: Taylor steps, local corrections"
    if shallow:
        return many, f"{contacts} with friction of slip speed, or sharing bodies: Taylor steps, local corrections"
    if _are_close(problem):
        return many, f"{contacts} on {problem.n} degrees of freedom, frequencies not far apart: Taylor steps"
    return None


def _are_close(problem: Problem) -> bool:
    """Whether frequencies are so close that explicit steps cost less than what exact structure does."""
    most = max(SPREAD * problem.n, CLOSE * min(problem.n, FULL))
    rings = problem.omega[problem.omega > 0.0]
    if problem.omega.size < problem.n:
        return False  # they are not known
    fast = fastest(problem)
    if problem.n < FULL and problem.zeta[problem.omega > 0.5 * problem.omega.max()].min(initial=1.0) < CLEAR:
        most *= UNDAMPED
    if fast <= most * rings.min(initial=fast):
        return True
    return problem.n_c == 1 and problem.n < FULL and fast <= most * _slowest_felt(problem)


def _slowest_felt(problem: Problem) -> float:
    """The lowest frequency, not 0, of the modes that one contact feels; 0 where they are not known."""
    try:
        modes = free_blocks(problem)
    except NoBlocks:
        return 0.0
    if not modes.modal:
        return 0.0
    share = np.sum((modes.force_1 @ problem.contacts.W) ** 2, axis=1)
    felt = (share > FELT * share.sum()) & (modes.w2 > 0.0)
    return float(np.sqrt(modes.w2[felt].min(initial=math.inf)))


def _rings(omega: Floats, zeta: Floats) -> float:
    """The highest frequency that is hardly damped, or the lowest of all."""
    return float(omega[zeta < CALM].max(initial=omega.min(initial=math.inf)))


def _held_by_calm_modes(problem: Problem) -> bool:
    """Whether modes that come to rest at once are far faster than all that ring: they hold explicit steps alone."""
    return fastest(problem) > APART * _rings(problem.omega, problem.zeta) > 0.0


def _against_exact(problem: Problem, rtol: float) -> str | None:
    """Why steps of exact structure cannot be taken, or are the wrong ones, or None."""
    return Guarded().refuses(problem) or too_far_apart(problem) or _calm_and_fast(problem, rtol)


def _calm_and_fast(problem: Problem, rtol: float) -> str | None:
    """What stands against exact structure beside modes that come to rest at once, or None.

    Measured on pairs and rows of masses, some of them tied by 1e4 to 1e6 rad/s: what friction leaves in such modes at
    each turn is beyond the polynomials of a step, 1 rtol at 1e-6, 100 at 1e-8, 10 000 at 1e-10; and where they creep
    back without swinging, steps follow them, thousands where implicit ones took 150.
    """
    return once_per(problem.linear, ("calm and fast", rtol), lambda: _calm_and_fast_modes(problem, rtol))


def _calm_and_fast_modes(problem: Problem, rtol: float) -> str | None:
    modes = free_blocks(problem)
    omega = np.sqrt(np.abs(modes.w2))
    if not (omega.size and modes.d.any()):
        return None
    zeta = 0.5 * modes.d / np.maximum(omega, 1e-300)
    limit = APART * _rings(omega, zeta)
    if not np.maximum(omega, np.abs(modes.d)).max() > limit > 0.0:
        return None
    if rtol >= BEARS_CALM_MODES and zeta[omega > limit].max(initial=0.0) < CREEPS:
        return None
    return f"modes that come to rest at once, more than {APART:.0f} times as fast as all that vibrate"
