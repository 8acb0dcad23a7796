"""What the checks of laws, elements and models share."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import FricmbError

Floats: TypeAlias = NDArray[np.float64]
#: A rule yields a sentence for every way in which it is broken.
Rule: TypeAlias = Callable[..., Iterator[str]]


class ConformanceError(FricmbError, AssertionError):
    """A declaration that breaks the rules; the message lists every rule it breaks."""


def findings(name: str, rules: Iterable[Rule], *arguments: Any) -> None:
    """Raise ConformanceError with all that the rules find, if they find anything."""
    broken = [f"{name}: {finding}" for rule in rules for finding in rule(*arguments)]
    if broken:
        raise ConformanceError("; ".join(broken))


def pickles(held: Any, *rest: Any) -> Iterator[str]:
    """It comes back equal from a pickle."""
    try:
        again = pickle.loads(pickle.dumps(held))
    except Exception as error:
        yield f"cannot be pickled: {type(error).__name__}: {error}"
        return
    if again != held:
        yield "does not come back equal from a pickle"
