"""The runs behind the figures."""

from __future__ import annotations

from functools import lru_cache

import fricmb as fm
from fricmb.models.brake4dof import brake4dof

#: Length of the runs; not given in the source, see :func:`fricmb.models.brake4dof`.
T_END = 700.0


@lru_cache(maxsize=16)
def run(case: str, *, t_end: float = T_END, rtol: float = 1e-8) -> fm.Solution:
    """One case over the whole braking, kept for the figures that share it."""
    return fm.simulate(brake4dof(case), t_end=t_end, rtol=rtol)
