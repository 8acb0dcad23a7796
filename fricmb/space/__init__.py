"""Bodies in space, their joints and contacts: ``fm.space``."""

from fricmb.space._ball import Ball
from fricmb.space._creep import LinearCreep, Polach, ShenHedrickElkins
from fricmb.space._directors import RigidBody
from fricmb.space._driven_spin import DrivenSpin
from fricmb.space._dry_friction import DryFriction
from fricmb.space._ground import ground_point
from fricmb.space._guides import Cylindrical, Prismatic
from fricmb.space._in_cylinder import InCylinder
from fricmb.space._kalker import KalkerCoefficients, kalker
from fricmb.space._on_plane import OnPlane
from fricmb.space._pad import Pad
from fricmb.space._points import Fixed, Rod, Universal
from fricmb.space._revolute import Revolute
from fricmb.space._rotor import Rotor
from fricmb.space._spherical import Spherical
from fricmb.space._torque import Torque
from fricmb.space._turn import turned
from fricmb.space._wheel_rail import WheelRail

__all__ = [
    "Ball",
    "Cylindrical",
    "DrivenSpin",
    "DryFriction",
    "Fixed",
    "InCylinder",
    "KalkerCoefficients",
    "LinearCreep",
    "OnPlane",
    "Pad",
    "Polach",
    "Prismatic",
    "Revolute",
    "RigidBody",
    "Rod",
    "Rotor",
    "ShenHedrickElkins",
    "Spherical",
    "Torque",
    "Universal",
    "WheelRail",
    "ground_point",
    "kalker",
    "turned",
]
