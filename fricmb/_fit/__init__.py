"""Parameters identified from measurements."""

from fricmb._fit._fit import fit
from fricmb._fit._result import Fit

__all__ = ["Fit", "fit"]
