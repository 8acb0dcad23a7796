"""What a run found: motion, contacts, transitions, energies.  Knows nothing of scenes."""

from fricmb.integrate.run.chunked_run import take
from fricmb.solution._derivatives import Derivatives
from fricmb.solution._differentiated import LooksFor
from fricmb.solution._energy import Energy, Reference
from fricmb.solution._events import ASKED, Event, Events
from fricmb.solution._names import Motion, Names, Vector
from fricmb.solution._run import Flags, Mechanics, Origin, Piece, Record, Run, first_bad, times_inside
from fricmb.solution._signals import owner_of
from fricmb.solution._solution import Solution
from fricmb.solution._stats import IslandStats, Stats
from fricmb.solution._stored import builder

__all__ = [
    "ASKED",
    "Derivatives",
    "Energy",
    "Event",
    "Events",
    "Flags",
    "IslandStats",
    "LooksFor",
    "Mechanics",
    "Motion",
    "Names",
    "Origin",
    "Piece",
    "Record",
    "Reference",
    "Run",
    "Solution",
    "Stats",
    "Vector",
    "builder",
    "first_bad",
    "owner_of",
    "take",
    "times_inside",
]
