"""Taylor steps as ``method="auto"`` takes them; a module of its own: most runs need not load it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fricmb.integrate.guard import Guard
from fricmb.integrate.integrator import Integrator
from fricmb.integrate.methods.bdf import Bdf
from fricmb.integrate.taylor import Taylor
from fricmb.integrate.timestepping import TimeStepping


@dataclass(frozen=True, kw_only=True)
class GuardedTaylor(Guard, Taylor):
    """Taylor steps; in reserve, where transitions crowd, time stepping."""

    reserve: ClassVar[type[Integrator]] = TimeStepping


@dataclass(frozen=True, kw_only=True)
class GuardedFewTaylor(Guard, Taylor):
    """Taylor steps with few contacts; in reserve the general method, which keeps the accuracy."""

    reserve: ClassVar[type[Integrator]] = Bdf
