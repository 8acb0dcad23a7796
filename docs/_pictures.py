"""Pictures of the built-in models: how they are built, and a run."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fricmb as fm
from fricmb.plot import BLUE, DARK, ORANGE, SolutionPlots
from fricmb.plot._scene import draw_scene

PAPER = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0}
# The degrees of freedom whose velocity is drawn, where the first two are not those that tell most.
TELLING = {
    "brake4dof": ["pad.x", "rotor.x"],
    "block_stack": ["block1.x", "block2.x", "block3.x"],
    "pad_rotor": ["pad.p1.x", "rotor.p1.x"],
    "rotor_doublet": ["disc.mode1", "pad1.x"],
    "stick_slip_chain": ["block1.x", "block5.x"],
    "dry_pendulum": ["arm.angle"],
    "andrews": ["K1.angle", "K3.angle"],
    "car_axis": ["left.y", "right.y"],
    "sprag_slip": ["arm.angle"],
    "slider_crank": ["slider.x"],
    "painleve_rod": ["rod.angle"],
    "four_bar": ["crank.angle", "rocker.angle"],
    "drive_train": ["wheel.angle", "disc.angle"],
}


def write(model, folder: Path) -> list[str]:
    """The names of two files: the scheme of a model, and its standard run."""
    scene = model.build()
    bodies = [part for part in scene.parts if isinstance(part, fm.RigidBody)]
    standing = any(body.points for body in bodies)
    scheme = draw_mechanism(scene, bodies) if standing else draw_scene(scene)
    sol = fm.simulate(scene, t_end=model.t_end, rtol=1e-6)
    plots = SolutionPlots(sol)
    run = plots.velocities(TELLING.get(model.name, list(sol.dof_names[:2])))
    names = [f"_{model.name}_{what}.png" for what in ("scheme", "run")]
    for figure, name in zip((scheme, run), names, strict=True):
        figure.savefig(folder / name, dpi=110)
    return names


def place(body, point) -> np.ndarray:
    """Where a point of a body is at the start."""
    c, s = np.cos(body.angle), np.sin(body.angle)
    centre = np.array([body.position.get(letter, 0.0) for letter in "xy"])
    return centre + np.array([[c, -s], [s, c]]) @ np.asarray(point, dtype=float)


def draw_mechanism(scene, bodies) -> Figure:
    """Rigid bodies as they stand at the start: each through its points, joints as circles, fixed ones with a hatch."""
    figure = Figure(figsize=(5.5, 3.6), layout="constrained")
    ax = figure.subplots()
    size = max(np.ptp([place(b, p) for b in bodies for p in [(0.0, 0.0), *b.points.values()]], axis=0))
    for body in bodies:
        at = np.array([place(body, p) for p in body.points.values()] or [place(body, (0.0, 0.0))])
        centre = place(body, (0.0, 0.0))
        if len(at) == 1 and body.points:
            at = np.vstack([at, 2.0 * centre - at])  # a bar about its centre of mass
        if len(at) == 1:
            ax.plot(*centre, "s", color="0.8", markeredgecolor=DARK, markersize=16)
        else:
            ax.fill(*at.T, facecolor="0.93", edgecolor=DARK, linewidth=2.5, joinstyle="round")
        middle = at.mean(axis=0)
        ax.annotate(body.name, middle, xytext=(8, 6), textcoords="offset points", fontsize=9, bbox=PAPER)
    for part in scene.parts:
        if isinstance(part, fm.Revolute | fm.RollerOnLine):
            _joint(ax, part, size)
    ax.set_aspect("equal")
    ax.margins(0.12)
    ax.set_axis_off()
    ax.set_title(str(scene.name), loc="left", fontsize=10)
    return figure


def _joint(ax, joint, size) -> None:
    """A pin, or the tip on its line; orange where it rubs."""
    body = getattr(joint.a, "body", joint.a)
    at = place(body, body.points[joint.a.point] if getattr(joint.a, "point", None) in body.points else (0.0, 0.0))
    face = "white" if joint.friction is None else ORANGE
    if not hasattr(joint.b, "body") and not isinstance(joint.b, fm.RigidBody):  # at the ground
        ax.plot(*(at - [0.0, 0.012 * size]), "^", color="0.75", markeredgecolor=DARK, markersize=15, zorder=3)
    if isinstance(joint, fm.RollerOnLine):
        ax.axhline(at[1], color=BLUE, linewidth=1.5, zorder=0)
    ax.plot(*at, "o", color=face, markeredgecolor=DARK, markersize=7, zorder=4)
