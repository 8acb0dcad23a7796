"""One thread of BLAS while something goes on to which more bring nothing.

OpenBLAS wakes a thread a core for a triangular system of eight rows, and the threads then spin for work; where the
cores have other work to do, such as a sweep's other processes, a call of some microseconds takes milliseconds.  Of the
eigenvalues of a matrix that is not symmetric, most is done by one thread even at a thousand rows: 545 rows took 0.4 s
with one thread and up to 20 s with two on a machine that was busy.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any


@lru_cache(maxsize=1)
def _controller() -> Any:
    """What sets the threads of the libraries of numpy and scipy; both have to be loaded to be found."""
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController().select(user_api="blas")


def one_thread(only: str | None = None) -> OneThread:
    """A context with one thread in each library, or in those of one kind: "openblas" leaves a solver's MKL alone.

    The setting belongs to the process: of several threads the first that asks has it (so does threadpoolctl), and has
    given it back when its context ends.
    """
    found = _controller().lib_controllers
    return OneThread([one for one in found if only in (None, one.internal_api)])


class OneThread:
    """One thread in each library while the context lasts; threadpoolctl's own looks up more than a small run takes."""

    def __init__(self, libraries: Sequence[Any]) -> None:
        self._libraries = libraries

    def __enter__(self) -> None:
        self._before = [(library, library.num_threads) for library in self._libraries]
        for library, count in self._before:
            if count != 1:
                library.set_num_threads(1)

    def __exit__(self, *raised: object) -> None:
        for library, count in self._before:
            if count != 1:
                library.set_num_threads(count)
