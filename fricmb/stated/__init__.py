"""What parts state in SymPy, and what selects it: read by audits and by derivatives, by no kernel."""

from fricmb.stated._statements import (
    MODULES,
    Read,
    Statement,
    coefficient,
    element,
    expression,
    joint,
    joint_motion,
    normal,
    place,
    place_motion,
    reads,
    scale,
    smooth,
)

__all__ = [
    "MODULES",
    "Read",
    "Statement",
    "coefficient",
    "element",
    "expression",
    "joint",
    "joint_motion",
    "normal",
    "place",
    "place_motion",
    "reads",
    "scale",
    "smooth",
]
