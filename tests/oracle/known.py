"""Runs that are known to be wrong, with the cause: a test holds this list exact, an entry that passes is removed.

``CELLS``: law, situation and method of the quick cells of the table.  ``PARTS``: element or joint, and method.
"""

from __future__ import annotations

_VARYING = "time stepping under a varying normal force: pairs of stick and slip without end"

CELLS: dict[tuple[str, str, str], str] = {
    ("Coulomb", "reversal under a varying load", "timestepping"): _VARYING,
    ("Elliptic", "reversal under a varying load", "timestepping"): _VARYING,
    ("LoadDependent", "reversal under a varying load", "timestepping"): _VARYING,
}

#: Element or joint and method.
PARTS: dict[tuple[str, str], str] = {}
