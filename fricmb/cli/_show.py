"""``fricmb list``, ``equations`` and ``plan``."""

from __future__ import annotations

import argparse
import dataclasses
import inspect
import sys
from collections.abc import Callable
from operator import attrgetter
from typing import Any

import fricmb as fm
from fricmb.cli._load import load
from fricmb.models import catalogue

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


def show_list(options: argparse.Namespace) -> int:
    """Models with their arguments, laws, integrators; those of installed packages, and what is wrong with them."""
    wanted = options.what
    if wanted in (None, "models"):
        print("models (fricmb run NAME --set argument=value)")
        for model in catalogue.values():
            _show_model(model.name, model.summary, model.build)
        found, broken = fm.laws.published("fricmb.models")
        for name, build in found.items():
            _show_model(name, _summary(build), build)
        _complain(broken)
    if wanted in (None, "parts"):
        _show_parts(summaries=wanted is not None)
    if wanted == "laws":
        _show_laws()
    elif wanted is None:
        found, broken = fm.laws.published("fricmb.friction_laws")
        print("laws          " + ", ".join([*fm.laws.names, *found]))
        _complain(broken)
    if wanted in (None, "integrators"):
        print("integrators   " + ", ".join(fm.integrators))
    return 0


def _show_model(name: str, summary: str, build: Callable[..., Any]) -> None:
    print(f"  {name}\n      {summary}")
    arguments = inspect.signature(build).parameters.values()
    held = (a.name if a.default is inspect.Parameter.empty else f"{a.name}={a.default!r}" for a in arguments)
    print("      " + ", ".join(held))


def _show_parts(*, summaries: bool) -> None:
    """Parts by what they are for, each with its first line if wanted."""
    print("parts (fm.NAME), by what they are for")
    for purpose, names in PURPOSES.items():
        if not summaries:
            print(f"  {purpose}: {', '.join(names)}")
            continue
        print(f"  {purpose}")
        for name in names:
            print(f"    {name}\n        {_summary(attrgetter(name)(fm))}")


def _show_laws() -> None:
    """Every law with its first line, its parameters, and whether it sticks."""
    found, broken = fm.laws.published("fricmb.friction_laws")
    print("laws (fricmb law NAME --set parameter=value)")
    for name, kind in {**{name: getattr(fm.laws, name) for name in fm.laws.names}, **found}.items():
        law = kind.example()
        sort = "set-valued" if law.kind != "smooth" else "with states" if law.states else "regularised"
        print(f"  {name} ({sort})\n      {_summary(kind)}")
        print("      " + ", ".join(f"{f.name}={getattr(law, f.name)!r}" for f in dataclasses.fields(law)))
    _complain(broken)


def _summary(held: Any) -> str:
    return (inspect.getdoc(held) or "").partition("\n")[0]


def _complain(broken: dict[str, str]) -> None:
    for name, why in broken.items():
        print(f"fricmb: {name!r} is left out: {why}", file=sys.stderr)


def show_equations(options: argparse.Namespace) -> int:
    """M and the right-hand side, as text or LaTeX."""
    equations = load(options.model, case=options.case, values=options.values).scene.equations()
    print(equations.latex() if options.latex else equations)
    return 0


def show_plan(options: argparse.Namespace) -> int:
    """The plan as it prints itself."""
    print(load(options.model, case=options.case, values=options.values).scene.plan())
    return 0
