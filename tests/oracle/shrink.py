"""A smaller scene that still fails."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from typing import Any

from .judge import Worker, judge, truth
from .problem import OracleError
from .spec import Spec, case_of

BAD = ("wrong", "noted", "stopped", "late", "crashed")


def smaller(spec: Spec) -> Iterator[Spec]:
    """One part less, a shorter run, plainer numbers."""
    for name in ("springs", "dampers", "pulls", "touches"):
        for i in range(len(getattr(spec, name))):
            if name == "touches" and len(spec.touches) == 1:
                continue
            other = deepcopy(spec)
            del getattr(other, name)[i]
            yield other
    changes: list[tuple[Any, str, Any]] = [
        (lambda s: s, "t_end", round(0.6 * spec.t_end, 3)), (lambda s: s, "belt_change", 0.0),
    ]  # fmt: skip
    for i, touch in enumerate(spec.touches):
        for name in ("swing", "slope"):
            if getattr(touch, name):
                changes.append((lambda s, i=i: s.touches[i], name, 0.0))
    for find, name, value in changes:
        other = deepcopy(spec)
        if getattr(find(other), name) != value:
            setattr(find(other), name, value)
            yield other


def fails(spec: Spec, method: str, rtol: float, worker: Worker) -> bool:
    """Whether the method still gets it wrong."""
    try:
        true = truth(case_of(spec))
    except OracleError:
        return False
    return not true.marginal and judge(true, method, rtol, worker).kind in BAD


def shrunk(spec: Spec, method: str, rtol: float, worker: Worker, attempts: int = 25) -> Spec:
    """The smallest found within so many attempts."""
    again = True
    while again and attempts > 0:
        again = False
        for other in smaller(spec):
            attempts -= 1
            if fails(other, method, rtol, worker):
                spec, again = other, True
                break
            if attempts <= 0:
                break
    return spec
