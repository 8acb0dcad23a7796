"""Runs that are known to be wrong, with the cause: a test holds this list exact, an entry that passes is removed.

``CELLS``: law, situation and method of the quick cells of the table.  ``PARTS``: element or joint, and method.
"""

from __future__ import annotations

_STATES = "residual of the state equations is not looked at: states stay at their limit after a reversal"
_VARYING = "time stepping under a varying normal force: pairs of stick and slip without end"

CELLS: dict[tuple[str, str, str], str] = {
    ("Ambrosio", "reversal", "collocation"): "a kink of the law is stepped over (the ledger notes it)",
    ("Coulomb", "reversal under a varying load", "timestepping"): _VARYING,
    ("Elliptic", "reversal under a varying load", "timestepping"): _VARYING,
    ("HyperbolicStribeck", "break-away", "taylor"): "steep weakening at the onset of slip",
    ("Jenkins", "reversal", "auto"): _STATES,
    ("Jenkins", "reversal", "bdf"): _STATES,
    ("Jenkins", "reversal", "collocation"): _STATES,
    ("Jenkins", "reversal", "radau"): _STATES,
    ("LoadDependent", "reversal under a varying load", "timestepping"): _VARYING,
    ("Logarithmic", "reversal", "taylor"): "the logarithm near r = 0 is beyond the series: it stops with an error",
}

#: Element or joint and method.
PARTS: dict[tuple[str, str], str] = {
    ("Rod", "taylor"): "a mechanism without contacts is not refused: a ValueError of numpy",
}
