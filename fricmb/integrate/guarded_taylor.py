"""Taylor steps as ``method="auto"`` takes them; a module of its own: most runs need not load it."""

from __future__ import annotations

from dataclasses import dataclass

from fricmb.integrate.guard import Guard
from fricmb.integrate.taylor import Taylor


@dataclass(frozen=True, kw_only=True)
class GuardedTaylor(Guard, Taylor):
    """Taylor steps; in reserve the general method, which keeps the accuracy where transitions crowd."""
