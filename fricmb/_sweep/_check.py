"""The values of all runs of a sweep, checked before the first is run: by their ranges where that will do.

What a part or a law of this package accepts is convex: of two values that it accepts it accepts all that lies between,
but for 0, which some refuse.  So where the corners of a range are accepted, and 0 if that lies inside, all within is.
Parts of other packages, values that are no floats, named parameters and ranges of which a corner is refused are checked
run by run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain, product
from typing import Any

import numpy as np

from fricmb._simulate._progress import bar
from fricmb.errors import FricmbError
from fricmb.scene import Scene
from fricmb.scene._other_values import check_values, stands_alone

#: Runs up to which each is checked by itself, corners up to which a range is, and runs from which on a bar is shown.
_FEW, _CORNERS, MANY = 200, 64, 5000


def check_runs(scene: Scene, runs: Sequence[Mapping[str, Any]], progress: bool) -> None:
    """Raise what :meth:`Scene.with_parameters` would, of the first run with a wrong name or value."""
    names = dict.fromkeys(chain(*runs)) if len(runs) > _FEW else {}
    of_part: dict[str, list[str]] = {}
    for name in names:
        of_part.setdefault(str(name).partition(".")[0], []).append(name)
    good = {name for names in of_part.values() if _is_good_range(scene, runs, names) for name in names}
    if len(runs) > _FEW and good == names.keys():
        return
    seen: set[tuple[Any, ...]] = set()
    with bar(len(runs), "run", "checks", progress and len(runs) > MANY) as told:
        for run in runs:
            values = {name: value for name, value in run.items() if name not in good}
            key = tuple(values.items()) if set(map(type, values.values())) == {float} else None
            if key not in seen:
                check_values(scene, values)
                if key is not None:
                    seen.add(key)
            told.update()


def _is_good_range(scene: Scene, runs: Sequence[Mapping[str, Any]], names: list[str]) -> bool:
    """Whether the corners of the range of a part's values are accepted, and therefore all that lies within."""
    levels = [_levels([run.get(name) for run in runs]) for name in names]
    if not 0 < np.prod([len(level) for level in levels]) <= _CORNERS:
        return False
    try:
        return all(stands_alone(scene, dict(zip(names, corner, strict=True))) for corner in product(*levels))
    except FricmbError:  # found again, with the run that it is in
        return False


def _levels(values: Sequence[Any]) -> set[float]:
    """The least and the largest of numbers, and 0 where it lies between; nothing where not all are finite numbers."""
    if not set(map(type, values)) <= {float, np.float64, int}:  # None: not all runs give it
        return set()
    try:
        column = np.array(values, dtype=float)
    except OverflowError:
        return set()
    low, high = float(column.min()), float(column.max())
    if not np.isfinite([low, high]).all():
        return set()
    return {low, high, 0.0} if low < 0.0 < high else {low, high}
