"""Bodies in space, their joints and contacts: ``fm.space``."""

from fricmb.space._ball import Ball
from fricmb.space._directors import RigidBody
from fricmb.space._ground import ground_point
from fricmb.space._guides import Cylindrical, Prismatic
from fricmb.space._on_plane import OnPlane
from fricmb.space._points import Fixed, Rod, Spherical, Universal
from fricmb.space._revolute import Revolute
from fricmb.space._rotor import Rotor
from fricmb.space._torque import Torque
from fricmb.space._turn import turned

__all__ = [
    "Ball",
    "Cylindrical",
    "Fixed",
    "OnPlane",
    "Prismatic",
    "Revolute",
    "RigidBody",
    "Rod",
    "Rotor",
    "Spherical",
    "Torque",
    "Universal",
    "ground_point",
    "turned",
]
