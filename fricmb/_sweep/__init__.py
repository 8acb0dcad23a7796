"""Many runs of one scene with different values."""

from fricmb._sweep._results import SweepResults
from fricmb._sweep._sweep import sweep

__all__ = ["SweepResults", "sweep"]
