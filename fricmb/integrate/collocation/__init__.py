"""Port-condensed collocation: Radau IIA nodes on the forces of contacts, the linear structure between them exact."""

from fricmb.integrate.collocation._collocation import Collocation

__all__ = ["Collocation"]
