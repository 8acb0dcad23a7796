"""Certified digits of bodies in space, each found in at least two ways that share no code: tests/data/space.json."""

import json
from pathlib import Path

import numpy as np

import fricmb as fm

CASES = json.loads((Path(__file__).parents[1] / "data" / "space.json").read_text())
DOWN = fm.Gravity("g", acceleration={"z": -9.81})


def case(name):
    """Parameters, and values as numbers."""
    held = CASES[name]
    values = {key: np.array(value, dtype=float) for key, value in held["values"].items()}
    return held["parameters"], values


def vector(sol, name, time=-1):
    return np.array([sol[f"{name}.{c}"][time] for c in "xyz"])


def top(speed=120.0, angle=0.4):
    p, _ = case("heavy_top_cusps")
    n = np.array([np.sin(angle), 0.0, np.cos(angle)])
    reach = p["com_from_tip"]
    return fm.space.Rotor(
        "top", mass=p["mass"], inertia_across=p["A_about_com"], inertia_axial=p["C"], position=reach * n, axis=n,
        spin=speed, stations={"tip": -reach},
    )  # fmt: skip


def heavy_top():
    body = top()
    return fm.Scene("heavy top", [body, fm.space.Spherical("tip", body.station("tip")), DOWN])


def pendulum():
    p, _ = case("spatial_pendulum_ball_joint")
    arm, omega = np.array(p["com_from_joint"]), np.array(p["omega0_body"], dtype=float)
    body = fm.space.RigidBody(
        "bob", mass=p["mass"], inertia=p["J_com"], position=arm, velocity=np.cross(omega, arm),
        angular_velocity=omega, points={"joint": tuple(-arm)},
    )  # fmt: skip
    return fm.Scene("pendulum", [body, fm.space.Spherical("hook", body.point("joint")), DOWN])


def slider_crank():
    """The rod is a rotor: it does not spin about itself."""
    centre, tip, slide = np.array([0.0, 0.1, 0.12]), np.array([0.0, 0.1, 0.2]), np.array([0.2, 0.0, 0.0])
    tip_moves, slide_moves = np.array([0.0, -0.48, 0.0]), np.array([0.24, 0.0, 0.0])
    along, turns = (tip - slide) / 0.3, (tip_moves - slide_moves) / 0.3
    crank = fm.space.RigidBody(
        "crank", mass=0.12, inertia=(1e-4, 1e-4, 1e-4), position=(centre + tip) / 2, velocity=tip_moves / 2,
        angular_velocity=(6.0, 0.0, 0.0), points={"hub": (0.0, 0.0, -0.04), "tip": (0.0, 0.0, 0.04)},
    )  # fmt: skip
    rod = fm.space.Rotor(
        "rod", mass=0.5, inertia_across=0.004, inertia_axial=1e-4, position=(tip + slide) / 2,
        velocity=(tip_moves + slide_moves) / 2, axis=along, angular_velocity=np.cross(along, turns),
        stations={"top": 0.15, "low": -0.15},
    )  # fmt: skip
    slider = fm.space.RigidBody("slider", mass=2.0, inertia=(1e-3,) * 3, position=slide, velocity=slide_moves)
    joints = [
        fm.space.Revolute("pin", crank.point("hub"), fm.space.ground_point(*centre), axis=(1, 0, 0)),
        fm.space.Spherical("big end", rod.station("top"), crank.point("tip")),
        fm.space.Spherical("small end", rod.station("low"), slider),
        fm.space.Prismatic("guide", slider, axis=(1, 0, 0)),
    ]
    return fm.Scene("slider crank in space", [crank, rod, slider, *joints, DOWN])


def wheel_on_an_arm():
    """A spinning wheel before the end of an arm that a hook holds."""
    arm = fm.space.RigidBody(
        "arm", mass=1.0, inertia=(0.02, 0.02, 0.01), position=(0, 0.3, 0),
        points={"hub": (0, 0.3, 0), "eye": (0, -0.3, 0)},
    )  # fmt: skip
    wheel = fm.space.Rotor(
        "wheel", mass=0.8, inertia_across=0.01, inertia_axial=0.02, position=(0, 0.6, 0), axis=(0, 1, 0), spin=60.0
    )
    return arm, wheel, fm.space.Spherical("hook", arm.point("eye"))
