"""Data of test rigs: read, identified, compared."""

from fricmb.measure._compare import Comparison
from fricmb.measure._identify import identify
from fricmb.measure._read import read
from fricmb.measure._types import Frf, Measured, Modes, TimeSeries

__all__ = ["Comparison", "Frf", "Measured", "Modes", "TimeSeries", "identify", "read"]
