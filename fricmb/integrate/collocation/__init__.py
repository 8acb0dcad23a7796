"""Port-condensed collocation: Radau IIA nodes on the forces of contacts, the linear structure between them exact."""

from fricmb.integrate.collocation.integrator import Collocation

__all__ = ["Collocation"]
