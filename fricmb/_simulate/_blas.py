"""Small scenes run with one thread of BLAS: on matrices of a few rows, threads cost more than they bring."""

from __future__ import annotations

import importlib.util
import sys
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any

import numpy as np

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


_NAME = "numpy.f2py"


def put_off_f2py() -> None:
    """Let numpy's translator of Fortran load when it is used.

    SciPy asks numpy for each of its parts by name when it is loaded, and numpy loads those it had put off.
    """
    spec = None if _NAME in sys.modules else importlib.util.find_spec(_NAME)
    if spec is None or spec.loader is None:
        return
    spec.loader = importlib.util.LazyLoader(spec.loader)
    module = importlib.util.module_from_spec(spec)
    sys.modules[_NAME] = np.f2py = module
    spec.loader.exec_module(module)
