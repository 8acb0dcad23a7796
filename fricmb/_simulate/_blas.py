"""Small scenes run with one thread of BLAS: on matrices of a few rows, threads cost more than they bring.

OpenBLAS wakes a thread a core for a triangular system of eight rows, and the threads then spin for work; where the
cores have other work to do, such as a sweep's other processes, a call of some microseconds takes milliseconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from fricmb._simulate._put_off import put_off_f2py

if TYPE_CHECKING:
    from fricmb.scene import Scene

#: Degrees of freedom from which on BLAS keeps its threads.
MANY = 200


@lru_cache(maxsize=1)
def _controller() -> Any:
    """What sets the threads of the libraries of numpy and scipy; both have to be loaded to be found."""
    put_off_f2py()
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController().select(user_api="blas")


def blas_threads(scene: Scene) -> AbstractContextManager[Any]:
    """One thread where no matrix of a scene gains from more; as many as there are otherwise.

    The setting belongs to the process: of several threads the first that asks has it (so does threadpoolctl), and has
    given it back when its run ends.
    """
    names = getattr(scene, "dof_names", ())
    if isinstance(names, tuple) and len(names) > MANY:  # what is no scene is told so further on
        return nullcontext()
    return _OneThread(_controller().lib_controllers)


class _OneThread:
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
