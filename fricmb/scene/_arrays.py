"""Arrays in declarations: checked, copied, read-only."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.values import Declaration, depth_of


def check_vector(
    owner: Declaration,
    argument: str,
    value: Any,
    n: int | None = None,
    *,
    above: float | None = None,
    minimum: float | None = None,
) -> tuple[Any, ...]:
    """A tuple of checked numbers, ``n`` of them if given."""
    accepted = "a sequence of numbers" if n is None else f"a sequence of {n} numbers"
    if (
        not isinstance(value, list | tuple | np.ndarray)
        or depth_of(value) != 1
        or len(value) == 0
        or (n is not None and len(value) != n)
    ):
        owner._refuse(argument, value, accepted)
    return tuple(owner._number(f"{argument}[{i}]", v, above=above, minimum=minimum) for i, v in enumerate(value))


def check_array(owner: Declaration, argument: str, value: Any) -> NDArray[Any]:
    """A read-only array of finite numbers; of objects where named parameters stand among them."""
    try:
        given = np.asarray(value)
    except ValueError:  # rows of different length
        owner._refuse(argument, value, "an array of numbers")
    if given.dtype == object:
        array = np.empty(given.shape, dtype=object)
        array.ravel()[:] = [owner._number(argument, entry) for entry in given.flat]
        if all(isinstance(entry, float) for entry in array.flat):
            array = array.astype(float)
    elif given.dtype.kind in "iuf":
        array = given.astype(float)
        if not np.all(np.isfinite(array)):
            owner._refuse(argument, array, "an array of finite numbers")
    else:
        owner._refuse(argument, value, "an array of numbers")
    array.setflags(write=False)
    return array
