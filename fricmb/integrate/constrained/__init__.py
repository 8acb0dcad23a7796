"""Integrators of mechanisms: constraints on position, velocity and acceleration held at every step."""

from fricmb.integrate.constrained.run import MULTISTEP_STAGES, run_mechanism, stages_for

__all__ = ["MULTISTEP_STAGES", "run_mechanism", "stages_for"]
