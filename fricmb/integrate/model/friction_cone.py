r"""The friction cone: what a contact can hold while it sticks.

.. math:: |F| \le \mu_s(N) \, N

Its two sides are ``friction_size`` and ``stick_limit``; all that decides between stick and slip asks for them, or for
one of the forms below.  In one direction break-away may exceed slip by different amounts in the two senses, ``|F + lean
mu_s N| <= mu_s N`` (``held_size``); loops, whose forces are shared, know no lean, and methods refuse it there.

A cone of another shape begins here: with another size (an ellipse whose axes are those of the rows is done without it,
by ``Elliptic.axis_scale`` and the scale of the rows in ``system/_contacts``), or with a limit that is given the force
as well, for a law that depends on its direction.  Slip has to follow: its velocity is along the normal of the set of
forces, which ``implicit/equations/friction_rows`` says for one direction and ``plane_slip`` there for several.

Methods for special structures know more, and write the same formula as it serves them:

- ``collocation/one_contact`` (``stick``, ``phase``): one limit for the run, and |F| with its rate and a bound of its
  second derivative, so that no step passes the instant of release;
- ``taylor`` (``event_search``, ``turning``, ``landing``, ``starting_modes``): one limit for the run;
- ``model/friction_discs``: projections on the set, whose radius they are given;
- ``implicit/stages/series_step``: F = -mu N u by powers of time;
- ``implicit/modes/mode_decision``: sizes of forces compared with limits of one instant, which do not change while
  forces are tried.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import coefficient, magnitude
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import Contacts, Floats, Ints
from fricmb.integrate.run.room_protocols import Laws


@kernel
def break_away(ports: Laws, laws: Table, k: int, s: Scratch, N: float) -> float:
    """Coefficient up to which a contact sticks: declared, or (``mu_s`` < 0) that of slip at r -> 0, under N."""
    if ports.mu_s[k] >= 0.0:
        return float(ports.mu_s[k])
    return float(coefficient(ports, laws, k, s, 0.0, N)[0])


@kernel
def stick_limit(ports: Laws, laws: Table, k: int, s: Scratch, N: float) -> float:
    """Force mu_s N up to which contact k sticks."""
    return float(break_away(ports, laws, k, s, N) * N)


def stick_limits(contacts: Contacts) -> Floats:
    """The forces up to which all contacts (n_c,) stick, where their normal forces are constant."""
    return np.asarray(np.abs(contacts.mu_s) * contacts.N)


@kernel
def friction_size(row: Ints, k: int, F: Floats) -> float:
    """What a force of contact k counts against its limit: its length."""
    return magnitude(row, k, F)


@kernel
def held_size(ports: Laws, k: int, F: Floats, limit: float) -> float:
    """What a force that holds contact k counts against its limit: its length, about the centre that it leans to."""
    lean = ports.lean[k]
    if lean != 0.0:
        return float(abs(F[ports.row[k]] + lean * limit))
    return float(magnitude(ports.row, k, F))


@kernel
def cone_margin(ports: Laws, laws: Table, k: int, s: Scratch, F: Floats, N: float) -> float:
    """How far the force of a contact is from its friction cone, mu_s N - |F|; below 0 it cannot stick."""
    limit = stick_limit(ports, laws, k, s, N)
    return float(limit - held_size(ports, k, F, limit))
