"""What a law gives way under a load that set-valued friction would hold."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Creep:
    """How a law answers a constant load below break-away, for a normal force of 1.

    Attributes
    ----------
    load : float
        Share of the break-away coefficient that is borne.
    break_away : float
        The largest coefficient on the way from rest to slip.
    velocity : float
        Speed at which the contact creeps on for ever; 0 for a set-valued law and for bristles that come to rest.
    displacement : float
        Distance that the contact gives way before the load is borne; 0 for a law without states.
    """

    load: float
    break_away: float
    velocity: float
    displacement: float
