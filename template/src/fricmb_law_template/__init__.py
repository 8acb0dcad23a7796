"""Friction laws for fricmb."""

from fricmb_law_template._valley import Valley

__all__ = ["Valley"]
