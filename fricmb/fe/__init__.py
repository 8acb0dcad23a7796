"""Matrices of finite element programs: read, checked, joined."""

from fricmb.fe._check import Check
from fricmb.fe._join import join
from fricmb.fe._model import FEModel
from fricmb.fe._read import read

__all__ = ["Check", "FEModel", "join", "read"]
