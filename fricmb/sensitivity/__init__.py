"""Derivatives of runs through stick and slip; asked for by ``simulate(..., sensitivities=...)``."""

from fricmb.sensitivity._derive import derive
from fricmb.sensitivity._seeds import check_names

__all__ = ["check_names", "derive"]
