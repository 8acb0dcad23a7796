"""The implicit driver: steps of all unknowns in a band, with joints and without."""

from fricmb.integrate.implicit.number_of_stages import stages_for
from fricmb.integrate.implicit.run import bdf_loop, run_mechanism

__all__ = ["bdf_loop", "run_mechanism", "stages_for"]
