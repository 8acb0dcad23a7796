"""What there is to compile, and doing one of it.

A kernel is compiled by itself, for the types that its annotations name.  A run of a built-in model brings about what
belongs to that model: its derived templates, and their machine code.
"""

from __future__ import annotations

import pkgutil
from importlib import import_module
from importlib.util import find_spec

from fricmb.integrate.compile.block import block_names, load_block
from fricmb.integrate.compile.kernel import compile_entry, entry_names

#: Share of the duration of a model's standard run that is run here: enough to begin.
_SHARE = 1e-3


def kernels() -> list[str]:
    """Tasks that compile each kernel of the integrators, those of one package beside each other."""
    import fricmb.integrate

    for module in pkgutil.walk_packages(fricmb.integrate.__path__, "fricmb.integrate."):
        import_module(module.name)
    import_module("fricmb.sensitivity")
    own = [name for name in entry_names() if name.startswith(("fricmb.integrate.", "fricmb.system.", "fricmb.sens"))]
    return [*(f"block {name}" for name in block_names()), *(f"entry {name}" for name in own)]


def runs() -> list[str]:
    """Tasks that run the solver of given equations, and each built-in model, for a moment; kernels are there.

    Only where SciPy, and SymPy for the equations of models, are there.  Where the package is built by itself they are
    not: kernels need neither, and to install them for that alone takes longer than these tasks do at a first run.  The
    last of the catalogue are the largest: they come first, so that nobody waits for one of them alone.
    """
    import fricmb as fm

    if not find_spec("scipy"):
        return []
    models = reversed(fm.models.catalogue) if find_spec("sympy") else ()
    return ["dae linear", *(f"model {name}" for name in models)]


def do(task: str) -> None:
    """Do one task."""
    kind, _, name = task.partition(" ")
    {"block": load_block, "entry": compile_entry, "model": _run_model, "dae": _run_equations}[kind](name)


def _run_model(name: str) -> None:
    import fricmb as fm

    model = fm.models.catalogue[name]
    fm.simulate(model.build(), t_end=_SHARE * model.t_end)


def _run_equations(_: str) -> None:
    import numpy as np

    import fricmb as fm

    def decay(t: float, y: np.ndarray, yp: np.ndarray) -> np.ndarray:
        return np.array([yp[0] + y[0], y[0] - y[1]])

    fm.solve_dae(decay, (0.0, 1.0), [1.0, 1.0], [-1.0, -1.0])
