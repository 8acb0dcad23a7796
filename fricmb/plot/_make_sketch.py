"""From a scene or a run to its sketch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.analysis import AnalysisError
from fricmb.plot._boxes import boxes
from fricmb.plot._contact import OPEN, static_limit
from fricmb.plot._fine import Floats, span_of, window_of
from fricmb.plot._linkage import linkage
from fricmb.plot._sketch import Motion, Sketch, is_limit, motions_at_start, motions_of
from fricmb.scene import Contact, RigidBody, SpaceBody

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Scenes of more bodies than this are not drawn.
DRAWN = 60
#: Swings that are shown unasked, and pictures for each of them.
SWINGS, PICTURES = 6, 32


def sketch_of_scene(scene: Any) -> Sketch:
    """A scene as it stands at the start."""
    return _sketch(scene, motions_at_start(scene), np.zeros(1), None)


def sketch_of_run(sol: Solution, times: Floats, magnify: float | None = None) -> Sketch:
    """A run at given times, with the forces and modes of its contacts."""
    seen = sol.at(times)
    sketch = _sketch(sol.scene, motions_of(seen), times, magnify)
    for touch in sketch.touches:
        force, limit = _on_paper(sol, seen, touch.name), static_limit(seen, touch.name)
        most = float((np.linalg.norm(force, axis=0) if limit is None else limit).max(initial=0.0)) or 1.0
        touch.force, touch.mode = force / most, seen.mode(touch.name)
        touch.limit = None if limit is None else np.where(touch.mode == OPEN, 0.0, limit / most)
    return sketch


def in_space(scene: Any) -> bool:
    """Whether a scene has bodies in space, and pictures of three dimensions."""
    return any(isinstance(body, SpaceBody) for body in scene.bodies)


def is_drawn(scene: Any) -> bool:
    """Whether there are pictures of a scene: not of too many bodies."""
    return len(scene.bodies) + len(scene.driven) <= DRAWN


def check_drawn(scene: Any) -> None:
    """Refuse a scene of too many bodies.

    Raises
    ------
    AnalysisError
        With their number.
    """
    if not is_drawn(scene):
        count = len(scene.bodies) + len(scene.driven)
        raise AnalysisError(f"a scene of {count} bodies is not drawn; at most {DRAWN} are")


def _sketch(scene: Any, position: Motion, t: Floats, magnify: float | None) -> Sketch:
    check_drawn(scene)
    turns = any(isinstance(body, RigidBody) for body in scene.bodies)
    if turns or not all(is_limit(joint) for joint in scene.joints):
        return linkage(scene, position, t)
    return boxes(scene, position, t, magnify)


def _on_paper(sol: Solution, seen: Solution, name: str) -> Floats:
    """Friction force (2, n) as it is drawn: along letters, along a guide; of a pin its moment in the first row."""
    part, force = sol.scene[name], seen.force(name)
    if isinstance(part, Contact):
        along = np.zeros((2, force.shape[0]))
        letters = {c for row in part.directions() for c, _ in row.vector}
        flat = not isinstance(part.a.owner, RigidBody) and len(letters) == 1
        for k, row in enumerate(part.directions()):
            for letter, share in row.vector:
                along[:, k] += share * np.array({"x": (1.0, 0.0), "y": (0.0, 1.0)}.get(letter, (0.0, 0.0)))
        if flat or not along.any():
            along[:, 0] = (1.0, 0.0)
        return np.asarray(along @ force)
    turn = float(getattr(part, "angle", 0.0) or 0.0) * np.ones(seen.t.size)
    if isinstance(part.b.owner, RigidBody):
        turn = turn + seen[f"{part.b.owner.name}.angle"]
    return np.asarray(np.array([np.cos(turn), np.sin(turn)]) * force[0])


def shown_span(sol: Solution, t_start: float | None, t_end: float | None) -> tuple[float, float, int]:
    """The part of a run that is shown, and how many pictures that takes.

    Unless it is given: a few swings, the last ones in which the motion is alive; all of a run that has no more.
    """
    whole = span_of(sol, t_start, t_end)
    names = _swinging(sol)

    def signals(seen: Solution) -> list[Floats]:
        return [seen.velocity(name) for name in names]

    if t_start is None and t_end is None and names:
        found = window_of(sol, signals, *whole, swings=SWINGS)
        if found is not None:
            return (*_with_event(sol, found), SWINGS * PICTURES)
    from fricmb.plot._fine import period_of

    period = period_of(sol, signals, *whole) if names else None
    swings = (whole[1] - whole[0]) / period if period else SWINGS
    return (*whole, int(np.clip(PICTURES * swings, 4 * PICTURES, 20 * PICTURES)))


def _with_event(sol: Solution, span: tuple[float, float]) -> tuple[float, float]:
    """The stretch, or where nothing happens in it one as long about the last transition."""
    t, length = sol.events.t, span[1] - span[0]
    if not t.size or ((t >= span[0]) & (t <= span[1])).any():
        return span
    begin = float(np.clip(t[-1] - 0.5 * length, sol.t_start, sol.t_end - length))
    return begin, begin + length


def _swinging(sol: Solution) -> list[str]:
    """Motions whose swings are seen: places of bodies, and angles where nothing else moves."""
    names = [name for name in sol.dof_names if not name.endswith(".angle")]
    swings = [name for name in names if np.ptp(sol.at(np.linspace(*span_of(sol, None, None), 200))[name]) > 0.0]
    return swings or [name for name in sol.dof_names if name not in names]
