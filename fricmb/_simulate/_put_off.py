"""A part of numpy that nobody here uses, and that takes longer to load than numpy itself."""

from __future__ import annotations

import importlib.util
import sys

import numpy as np

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
