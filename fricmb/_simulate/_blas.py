"""Small scenes run with one thread of BLAS: on matrices of a few rows, threads cost more than they bring."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any

from fricmb._simulate._put_off import put_off_f2py
from fricmb.integrate.run.one_thread import one_thread

if TYPE_CHECKING:
    from fricmb.scene import Scene

#: Degrees of freedom from which on BLAS keeps its threads.
MANY = 200


def blas_threads(scene: Scene) -> AbstractContextManager[Any]:
    """One thread where no matrix of a scene gains from more; as many as there are otherwise."""
    names = getattr(scene, "dof_names", ())
    if isinstance(names, tuple) and len(names) > MANY:  # what is no scene is told so further on
        return nullcontext()
    put_off_f2py()
    return one_thread()
