"""Derivatives of runs through stick and slip; asked for by ``simulate(..., sensitivities=...)``."""

from fricmb.sensitivity._derive import derive

__all__ = ["derive"]
