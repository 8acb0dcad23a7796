"""From a flip onto the cycles of twice the period."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmb.analysis._errors import AnalysisError
from fricmb.analysis.cycles._branch import Branch
from fricmb.analysis.cycles._continue import follow
from fricmb.analysis.cycles._predict import Point, correct, direction
from fricmb.analysis.cycles._specials import Flip, NeimarkSacker, Special

_WHO = "switch"
#: First step along the eigenvector, in units of the cycle's extent.
_STEP = 0.02


def switched(branch: Branch, special: Special, to: float, points: int, progress: bool) -> Branch:
    """The branch of twice the period."""
    if not isinstance(special, Flip):
        why = "there motion goes on to a torus" if isinstance(special, NeimarkSacker) else "the branch goes on itself"
        raise AnalysisError(f"{_WHO}: only a Flip has another branch of cycles; at a {type(special).__name__} {why}")
    orbit = special.cycle.orbit
    shooting, over = orbit.shooting, branch.over
    drive = None if shooting.drive is None else replace(shooting.drive, laps=2 * shooting.drive.laps)
    twice = replace(shooting, drive=drive, section=None, phase=0.5 * shooting.phase).orbit(
        orbit.y, 2.0 * orbit.T, (over,)
    )
    scale = abs(to - special.value) or 1.0
    B = orbit.tangent
    reduced = np.linalg.lstsq(B, orbit.arc.by_state @ B, rcond=None)[0]
    values, vectors = np.linalg.eig(reduced)
    v = np.real(vectors[:, np.argmin(np.abs(values + 1.0))])
    step = np.zeros(v.size + (2 if drive is None else 1))
    step[: v.size] = v / np.linalg.norm(v)
    found = correct(twice, over, scale, _STEP * step, step, 1e-11)
    if found is None:
        raise AnalysisError(f"{_WHO}: no cycle of twice the period found near {over} = {special.value:.10g}")
    ahead = direction(found, over, scale)
    ahead = ahead if float(ahead @ step) >= 0.0 else -ahead
    moved = float(found.shooting.flow.scene.parameters[over]) - special.value
    end = to if (to - special.value) * moved > 0 else special.value + np.sign(moved) * abs(to - special.value)
    return follow(Point(orbit=found, over=over, p_scale=scale, forward=ahead), end, points, 0.1, progress)
