"""Checks for other people's laws, elements, models and integrators: what a run relies on, tried with numbers."""

from fricmb.testing._base import ConformanceError
from fricmb.testing._element import check_element
from fricmb.testing._integrator import check_integrator
from fricmb.testing._law import check_law
from fricmb.testing._model import check_model

__all__ = ["ConformanceError", "check_element", "check_integrator", "check_law", "check_model"]
