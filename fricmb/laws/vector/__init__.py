"""Laws whose direction matters: cones that are not round, sliding together with spinning."""

from fricmb.laws.vector._contensou import Contensou
from fricmb.laws.vector._contensou_pade import ContensouPade
from fricmb.laws.vector._elliptic import Elliptic
from fricmb.laws.vector._offset import Offset

__all__ = ["Contensou", "ContensouPade", "Elliptic", "Offset"]
