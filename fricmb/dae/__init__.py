"""Implicit differential-algebraic equations of index 1: variable-step, variable-order BDF with scipy's conventions."""

from fricmb.dae._driver import solve_dae
from fricmb.dae._result import DaeResult, DaeSolution

__all__ = ["DaeResult", "DaeSolution", "solve_dae"]
