"""Checks for other people's laws, elements and models: what a run relies on, tried with numbers."""

from fricmb.testing._base import ConformanceError
from fricmb.testing._element import check_element
from fricmb.testing._law import check_law
from fricmb.testing._model import check_model

__all__ = ["ConformanceError", "check_element", "check_law", "check_model"]
