"""Steps of all unknowns in a band: bodies that turn, joints as constraints, and contacts in numbers."""

from fricmb.integrate.constrained.many_rows import has_many_rows
from fricmb.integrate.constrained.run import run_mechanism, stages_for

__all__ = ["has_many_rows", "run_mechanism", "stages_for"]
