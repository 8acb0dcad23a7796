"""Integrators of mechanisms: constraints on position, velocity and acceleration held at every step."""

from fricmb.integrate.constrained._run import run_mechanism, stages_for

__all__ = ["run_mechanism", "stages_for"]
