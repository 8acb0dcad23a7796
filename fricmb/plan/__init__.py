"""Plans: what will be built from a scene, what is left out and why."""

from fricmb.plan._make import make_plan
from fricmb.plan._plan import Island, Omission, Plan, Selection
from fricmb.plan._same import common
from fricmb.plan._truncate import truncated

__all__ = [
    "Island",
    "Omission",
    "Plan",
    "Selection",
    "common",
    "make_plan",
    "truncated",
]
