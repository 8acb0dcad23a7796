"""Prescribed motions: their values at any time, and their positions at the start of a run."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.scene import Scene
from fricmb.system import DrivenMotion, driven_motions

_DOUBLES = ctypes.POINTER(ctypes.c_double)
_TEMPLATE = ctypes.CFUNCTYPE(None, _DOUBLES, _DOUBLES, _DOUBLES)


class DrivenMotions:
    """The prescribed motions of a scene, body by body; given velocities are integrated from t = 0."""

    def __init__(self, scene: Scene) -> None:
        self._motions = list(driven_motions(scene.driven).values())

    @property
    def names(self) -> list[str]:
        """Names such as "belt.x"."""
        return [motion.name for motion in self._motions]

    def evaluate(self, t: Floats) -> tuple[Floats, Floats]:
        """Positions and velocities (n_driven, n_t); a position without a closed form is nan."""
        position, velocity = np.empty((2, len(self._motions), t.size))
        for i, motion in enumerate(self._motions):
            if motion.rate is not None:
                position[i], velocity[i] = motion.start + motion.rate * t, motion.rate
            else:
                position[i], velocity[i] = _evaluate(motion, t)
        return position, velocity

    def shift_to(self, wanted: Mapping[str, float], t: float) -> dict[str, float]:
        """By how much to shift the positions that are integrals, so that they are as wanted at t.

        A motion that is not named has its declared start there.
        """
        position, _ = self.evaluate(np.array([t]))
        found = {}
        for motion, (there,) in zip(self._motions, position.tolist(), strict=True):
            difference = wanted.get(motion.name, motion.start) - there
            if motion.integrated and np.isfinite(difference) and difference != 0.0:
                found[motion.name] = difference
        return found


def shifted(scene: Scene, shift: Mapping[str, float]) -> Scene:
    """The scene with driven positions shifted."""
    for body in scene.driven if shift else ():
        motions = [motion for motion in driven_motions([body]).values() if motion.name in shift]
        if motions:
            moved = {motion.letter: motion.start + shift[motion.name] for motion in motions}
            scene = scene.replace(body.name, position={**body.position, **moved})
    return scene


def _evaluate(motion: DrivenMotion, t: Floats) -> tuple[Floats, Floats]:
    signal = motion.signal()
    call = _TEMPLATE(signal.template.address)
    p = (ctypes.c_double * max(1, len(signal.parameters)))(*signal.parameters)
    out, x = (ctypes.c_double * 3)(), (ctypes.c_double * 1)()
    values = np.empty((2, t.size))
    for i, time in enumerate(t.tolist()):
        x[0] = time
        call(x, p, out)
        values[:, i] = out[0], out[1]
    if not signal.template.facts.get("closed", True):
        values[0] = np.nan
    return values[0], values[1]
