"""Time stepping: implicit steps of all contacts at once, whose transitions are not stepped to."""

from fricmb.integrate.timestepping._timestepping import TimeStepping

__all__ = ["TimeStepping"]
