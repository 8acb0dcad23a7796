"""A law is tried with numbers before a run: what it writes, that it is finite, and that it opposes slip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.equations import function
from fricmb.errors import LawError

Floats = NDArray[np.float64]

#: Slip speeds that are tried, in any unit.
SPEEDS = (0.0, 1e-12, 1e-6, 1e-3, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e6, 1e300)
#: Up to this speed, which nothing reaches in any unit, a force must not drive the slip.
DRIVES = 1e6
#: What is written beyond the end of a kernel's output, to see whether it is overwritten.
_GUARD = -1.2345678901234567e-123
_BEYOND = 64

_good: dict[tuple[Any, ...], bool] = {}


def try_law(law: Any, what: str, template: Any, p: Sequence[float], d: int, n_z: int) -> None:
    """Raise :class:`LawError`, naming ``what``, where the compiled law breaks a rule; once for each set of numbers.

    Parameters
    ----------
    law : FrictionLaw
    what : str
        What messages call the contact.
    template : Template
        Its compiled law.
    p : sequence of float
        The law's numbers.
    d, n_z : int
        Tangential directions and states.
    """
    key = (template.address, tuple(p), d, n_z)
    if key in _good:
        return
    smooth = template.facts["kind"] == "smooth"
    numbers, more = np.array(p, dtype=float), int("switch" in template.facts)
    found = _smooth(template.address, numbers, d, n_z, more) if smooth else _coefficient(template.address, numbers)
    for fault in found:
        raise LawError(f"{what}: its law {type(law).__name__} {fault}")
    if len(_good) > 4096:
        _good.clear()
    _good[key] = True


def _call(address: int, x: Floats, p: Floats, size: int) -> tuple[Floats, bool]:
    """What a kernel writes, and whether it writes more."""
    out = np.full(size + _BEYOND, _GUARD)
    function(address)(np.ascontiguousarray(x), p, out)
    return out[:size], bool((out[size:] != _GUARD).any())


def _faults(out: Floats, beyond: bool, rows: str, at: str) -> Iterator[str]:
    if beyond:
        yield f"writes more than the {len(out)} numbers {rows}"
    left = np.flatnonzero(out == _GUARD)
    if len(left):
        yield f"leaves out[{left[0]}] of the {len(out)} numbers {rows} unwritten"
    bad = np.flatnonzero(~np.isfinite(out))
    if len(bad):
        yield f"is not finite at {at}: out[{bad[0]}] of {rows} is {out[bad[0]]}"


def _coefficient(address: int, p: Floats) -> Iterator[str]:
    for r in SPEEDS:
        out, beyond = _call(address, np.array([r, 1.0]), p, 3)
        yield from _faults(out, beyond, "[mu, d mu/dr, d mu/dN]", f"slip speed {r:g}, normal force 1")


def _smooth(address: int, p: Floats, d: int, n_z: int, more: int) -> Iterator[str]:
    rows, columns = d + n_z, d + 1 + n_z
    for r in SPEEDS:
        for a in range(d):
            for sign in (1.0, -1.0):
                x = np.zeros(columns)
                x[a], x[d] = sign * r, 1.0
                out, beyond = _call(address, x, p, rows * (columns + 1) + more)
                at = f"v = {x[:d].tolist()}, normal force 1{', states 0' if n_z else ''}"
                yield from _faults(out, beyond, "[force, rates of states, Jacobian by rows]", at)
                if 0.0 < r <= DRIVES and out[a] * sign > 1e-12 * np.abs(out[:d]).max():
                    yield (
                        f"drives the slip: the force at {at} is {out[:d].tolist()}; a force on the contact's a has the"
                        " sign of -v"
                    )
