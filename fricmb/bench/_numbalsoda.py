"""LSODA and DOP853 of numbalsoda: the integration never comes back to Python (an optional package)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, types
from numba.extending import intrinsic

from fricmb.bench._kernels import right_hand_side
from fricmb.bench._method import Method
from fricmb.bench._peers import Answer, PeerError, Smoothed
from fricmb.bench._reference import Floats
from fricmb.bench._smooth import SmoothScene

#: Steps allowed between two output times.
MANY = 10_000_000


@intrinsic
def _at(typingctx: Any, address: Any) -> Any:
    """The address as a pointer."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.int64), codegen


@lru_cache(maxsize=1)
def _callback() -> Any:
    """The right-hand side as numbalsoda calls it; its data are addresses and lengths of the scene's arrays.

    Addresses are below 2^53: a double holds them exactly.
    """
    from numbalsoda import lsoda_sig

    @cfunc(lsoda_sig)
    def rhs(t: float, u: Any, du: Any, p: Any) -> None:
        size = int(p[0])
        floats = carray(_at(int(p[1])), (int(p[2]),), np.float64)
        ints = carray(_at(int(p[3])), (int(p[4]),), np.int64)
        right_hand_side(t, carray(u, (size,)), carray(du, (size,)), floats, ints)

    return rhs


@dataclass(frozen=True)
class Numbalsoda(Smoothed):
    """``lsoda`` or ``dop853`` of numbalsoda; neither takes a Jacobian."""

    function: str

    @property
    def name(self) -> str:  # type: ignore[override]
        """As shown."""
        return f"numbalsoda {self.function}"

    def solve(self, scene: SmoothScene, t: Floats, rtol: float, atol: Floats, steps: bool) -> Answer:
        """Run it; ``atol`` is a number there: the smallest.

        It does not tell its own steps: where these are asked for, 20 001 times.
        """
        import numbalsoda

        floats, ints = scene.floats, scene.ints
        size = len(scene.start)
        data = np.array([size, floats.ctypes.data, len(floats), ints.ctypes.data, len(ints)], dtype=np.float64)
        times = np.linspace(float(t[0]), float(t[-1]), 20_001) if steps else np.ascontiguousarray(t, dtype=float)
        options: dict[str, Any] = {"data": data, "rtol": rtol, "atol": float(atol.min()), "mxstep": MANY}
        answer, success = getattr(numbalsoda, self.function)(_callback().address, scene.start.copy(), times, **options)
        if not success or not np.isfinite(answer).all():
            raise PeerError(f"{self.name}: gave up, without saying why")
        return Answer(t=times, y=np.ascontiguousarray(answer.T))


def numbalsoda_methods() -> list[Method]:
    """Both where the package is installed."""
    return [Numbalsoda("lsoda"), Numbalsoda("dop853")] if find_spec("numbalsoda") else []
