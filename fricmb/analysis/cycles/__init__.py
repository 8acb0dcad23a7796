"""Periodic motion: limit cycles, their branches and bifurcations."""

from fricmb.analysis.cycles._branch import Branch
from fricmb.analysis.cycles._continue import continue_cycle
from fricmb.analysis.cycles._cycle import Cycle, limit_cycle
from fricmb.analysis.cycles._lyapunov import Lyapunov, lyapunov
from fricmb.analysis.cycles._specials import (
    Flip,
    Fold,
    Grazing,
    NeimarkSacker,
    Special,
    StickAppears,
    StickDisappears,
)

__all__ = [
    "Branch",
    "Cycle",
    "Flip",
    "Fold",
    "Grazing",
    "Lyapunov",
    "NeimarkSacker",
    "Special",
    "StickAppears",
    "StickDisappears",
    "continue_cycle",
    "limit_cycle",
    "lyapunov",
]
