"""Taylor steps with local corrections at transitions, for chains and their like with many contacts."""

from fricmb.integrate.taylor.integrator import Taylor

__all__ = ["Taylor"]
