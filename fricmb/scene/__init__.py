"""Declarations: the parts of a scene and the scene itself.  No mathematics, no arrays of the whole."""

from typing import Any

from fricmb.scene._axes import Direction, check_axis, check_ends, direction
from fricmb.scene._axial import AxialElement
from fricmb.scene._bodies import Body, Driven
from fricmb.scene._contact import Contact
from fricmb.scene._damper import Damper
from fricmb.scene._driven_joints import DrivenAngle, DrivenSlide
from fricmb.scene._dry_friction import DryFriction
from fricmb.scene._element import Element
from fricmb.scene._expressions import Uses, check_expression, expression_uses
from fricmb.scene._force import Force
from fricmb.scene._forms import LinearForm
from fricmb.scene._gear import Gear
from fricmb.scene._impact_law import ImpactLaw, impact_law
from fricmb.scene._joint import Joint
from fricmb.scene._joints import Fixed, Prismatic, Revolute, Rod
from fricmb.scene._matrix import MatrixElement
from fricmb.scene._modal import ModalBody, Point
from fricmb.scene._modal_from import modal_matrices
from fricmb.scene._parameter_units import parameter_unit
from fricmb.scene._part import GROUND, End, Ground, Part
from fricmb.scene._point import PointDamper, PointSpring
from fricmb.scene._rigid import GroundPoint, RigidBody, RigidPoint, ground_point
from fricmb.scene._rollers import RollerOnCircle, RollerOnLine
from fricmb.scene._rope import Rope
from fricmb.scene._scene import Scene
from fricmb.scene._space_body import SpaceBody, SpacePoint
from fricmb.scene._spring import Spring
from fricmb.scene._stops import Backlash, Stop
from fricmb.scene._symbols import coordinate, speed
from fricmb.scene._tree import Branch, Loop, Topology, topology
from fricmb.scene._turning import Gravity, Torque, TorsionDamper, TorsionSpring
from fricmb.scene._wheel import Wheel
from fricmb.values import Parameter, parameter

__all__ = [
    "GROUND",
    "AxialElement",
    "Backlash",
    "Body",
    "Branch",
    "Contact",
    "Damper",
    "Direction",
    "Driven",
    "DrivenAngle",
    "DrivenSlide",
    "DryFriction",
    "Element",
    "End",
    "Fixed",
    "Force",
    "Gear",
    "Gravity",
    "Ground",
    "GroundPoint",
    "ImpactLaw",
    "Joint",
    "LinearForm",
    "Loop",
    "MatrixElement",
    "ModalBody",
    "Parameter",
    "Part",
    "Point",
    "PointDamper",
    "PointSpring",
    "Prismatic",
    "Revolute",
    "RigidBody",
    "RigidPoint",
    "Rod",
    "RollerOnCircle",
    "RollerOnLine",
    "Rope",
    "Scene",
    "SpaceBody",
    "SpacePoint",
    "Spring",
    "Stop",
    "Topology",
    "Torque",
    "TorsionDamper",
    "TorsionSpring",
    "Uses",
    "Wheel",
    "check_axis",
    "check_ends",
    "check_expression",
    "coordinate",
    "direction",
    "expression_uses",
    "ground_point",
    "impact_law",
    "modal_matrices",
    "parameter",
    "parameter_unit",
    "speed",
    "t",
    "topology",
]


def __getattr__(name: str) -> Any:
    # SymPy is imported when time is first asked for, not before
    if name == "t":
        from fricmb.scene._symbols import time

        return time()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
