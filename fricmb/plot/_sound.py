"""A signal as sound."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fricmb.analysis import AnalysisError
from fricmb.analysis._sampling import signal_of

if TYPE_CHECKING:
    from fricmb.solution import Solution

RATE = 44100
#: Loudest sample, and how long the sound swells and fades.
_LEVEL, _FADE = 0.9, 0.01


def write_sound(
    sol: Solution,
    name: str,
    path: str | PathLike[str],
    *,
    seconds: float | None,
    speed: float,
    span: tuple[float, float],
) -> Path:
    """Write a signal of a stretch of a run as a mono wav file of 16 bits.

    ``seconds``: length of the sound, or None for ``speed`` units of time in each second.
    """
    from scipy.io import wavfile

    length = (span[1] - span[0]) / speed if seconds is None else float(seconds)
    if not (np.isfinite(length) and 0.05 <= length <= 600.0):
        raise AnalysisError(
            f"sound: it would last {length:g} s; give seconds= from 0.05 to 600, or a speed= that leads there"
        )
    t = np.linspace(*span, int(length * RATE))
    x = signal_of(sol, name, t)
    x = x - x.mean()
    fade = np.minimum(1.0, np.minimum(np.arange(x.size), np.arange(x.size)[::-1]) / (_FADE * RATE))
    largest = float(np.abs(x * fade).max())
    if largest > 0.0:
        x = x * fade * (_LEVEL / largest)
    file = Path(path)
    wavfile.write(file, RATE, np.round(32767 * x).astype(np.int16))
    return file
