"""What a run is to be differentiated by."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.errors import SceneError, shown, unknown_name
from fricmb.scene import Scene
from fricmb.values import has_entries, value_of

#: Stands for all initial values.
STATE = "state"


def check_names(scene: Scene, given: Any) -> tuple[str, ...]:
    """Names of parameters, "state" first if it is asked for; errors name those near."""
    names = (given,) if isinstance(given, str) else given
    if not has_entries(names) or not all(isinstance(name, str) for name in names):
        raise SceneError(
            f'sensitivities: got {shown(given)}; expected names in scene.parameters, or "state" for all initial values'
        )
    known = scene.parameters
    for name in (names := tuple(dict.fromkeys(names))):
        if name == STATE:
            continue
        if name not in known and not _slot(scene, name):
            raise unknown_name(f"parameter of scene {scene.name!r}", name, [*known, STATE])
        value = known.get(name, 0.0)
        if np.ndim(value_of(value)):
            raise SceneError(
                f"sensitivities: {name!r} is an array of shape {np.shape(value_of(value))}, not one number"
            )
    return tuple(sorted(names, key=lambda name: name != STATE))


def _slot(scene: Scene, name: str) -> bool:
    """Whether a name is a slot that a part accepts (an initial value that was not given, say)."""
    head, _, path = name.partition(".")
    return head in scene and bool(path) and path in scene[head].settable()
