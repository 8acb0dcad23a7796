"""Time stepping: implicit steps of all contacts at once, whose transitions are not stepped to."""

from fricmb.integrate.timestepping.integrator import TimeStepping

__all__ = ["TimeStepping"]
