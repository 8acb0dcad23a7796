"""Parts of scenes by what they are for: ``fricmb list parts``."""

from __future__ import annotations

#: Names in ``fm`` and ``fm.space``, by purpose.
PURPOSES: dict[str, tuple[str, ...]] = {
    "bodies": (
        "Body", "RigidBody", "ModalBody", "Driven", "space.Ball", "space.Rotor", "space.RigidBody",
    ),
    "joints that hold": (
        "Revolute", "Prismatic", "Fixed", "Rod", "space.Revolute", "space.Prismatic", "space.Cylindrical",
        "space.Spherical", "space.Universal", "space.Fixed", "space.Rod",
    ),
    "surfaces that something slides or rolls on": (
        "RollerOnLine", "RollerOnCircle", "Wheel", "space.OnPlane", "space.InCylinder", "space.WheelRail",
    ),
    "friction": ("Contact", "DryFriction", "space.DryFriction", "space.Pad"),
    "springs and dampers": (
        "Spring", "Damper", "PointSpring", "PointDamper", "TorsionSpring", "TorsionDamper", "MatrixElement",
    ),
    "stops, play, and the law of impact": ("Stop", "Backlash", "ImpactLaw"),
    "transmissions": ("Gear", "Rope"),
    "drives and loads": (
        "Force", "Torque", "Gravity", "DrivenAngle", "DrivenSlide", "space.Torque", "space.DrivenSpin",
    ),
}  # fmt: skip
