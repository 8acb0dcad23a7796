"""A check of a run against the equations of its scene, on a path of its own; asked for by ``sol.audit()``."""

from fricmb.audit._audit import audit
from fricmb.audit._result import Audit, Check

__all__ = ["Audit", "Check", "audit"]
