"""The implicit driver: steps of all unknowns in a band, with joints and without."""

from fricmb.integrate.constrained.number_of_stages import stages_for
from fricmb.integrate.constrained.run import run_mechanism

__all__ = ["run_mechanism", "stages_for"]
