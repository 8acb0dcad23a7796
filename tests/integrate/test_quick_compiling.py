"""Kernels go through fewer passes than numba's, with types that are remembered: they compute what Python computes."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest
from numba import njit
from numba.core.errors import TypingError

import fricmb
from fricmb.integrate.compile.compilers import MachineCompiler
from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.compile.long_loops import long_loops
from fricmb.integrate.compile.plain import is_plain
from fricmb.integrate.problem import Floats

compiled = njit(error_model="numpy", pipeline_class=MachineCompiler)


def mixed(i, x, z):
    """Operators on numbers of every kind, in every order."""
    a = i + x
    b = x + i
    c = z * i - x / z
    d = i // 2 + i % 3
    e = i / 2
    f = -x if i > 2 else abs(z)
    return a + 2.0 * b + (c * c.conjugate()).real + d + e + f + (i > 1) + x**2 + 2**i + max(x, i) + min(i, 3, 2)


@pytest.mark.parametrize("given", [(3, 0.7, 1.0 + 2.0j), (1, -2.5, 0.5j), (np.int8(4), np.float64(0.1), 2.0 + 0.0j)])
def test_remembered_types_are_those_of_the_operands(given):
    # each call is typed for its own kinds of numbers, the later ones with what the earlier ones have left
    assert compiled(mixed)(*given) == pytest.approx(mixed(*given), rel=1e-14)
    assert njit(mixed)(*given) == compiled(mixed)(*given)


def arrays(x, y):
    """Expressions of arrays, of one and of many operators."""
    both = x + y
    part = np.sqrt(np.abs(x * y)) + 2.0 * x[1:].sum() - y
    part[:2] *= 3.0
    return both.sum() + part.sum() + (x > 0.0).any() + np.maximum(x, y)[0] + (-x)[1]


def test_expressions_of_arrays():
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=5), rng.normal(size=5)
    assert compiled(arrays)(x, y) == pytest.approx(arrays(x, y), rel=1e-14)


def shadowed(n, flag):
    """Names that change their type, and branches that a constant decides."""
    value = 0
    for i in range(n):
        if flag:
            value = value + 0.5 * i
    limit = None
    if limit is not None:
        value = value / 0
    return value


def test_names_that_change_their_type():
    assert compiled(shadowed)(5, True) == 5.0
    assert compiled(shadowed)(5, False) == 0.0


def add_to_all(x: Floats, y: Floats) -> None:
    """Walk along long arrays."""
    for i in range(x.shape[0]):
        x[i] += 2.0 * y[i]


def plain(x: Floats, y: Floats) -> None:
    """The same, not marked."""
    for i in range(x.shape[0]):
        x[i] += 2.0 * y[i]


@pytest.mark.skipif(is_plain(), reason="numba's own passes vectorise all loops")
def test_marked_loops_alone_are_vectorised(monkeypatch, tmp_path):
    for name in ("FRICMB_CACHE_DIR", "NUMBA_CACHE_DIR"):
        monkeypatch.setenv(name, str(tmp_path))
    for kernel, wide in ((entry(long_loops(add_to_all)), True), (entry(plain), False)):
        x, y = np.arange(37.0), np.linspace(-1.0, 1.0, 37)
        wanted = x + 2.0 * y
        kernel(x, y)
        np.testing.assert_array_equal(x, wanted)
        (code,) = kernel.inspect_llvm().values()
        assert (" x double>" in code) == wide


def test_an_error_of_typing_names_the_kernel_and_the_line():
    def wrong(x):
        return x + "one"

    line = wrong.__code__.co_firstlineno + 1
    with pytest.raises(TypingError, match=rf'(?s)test_quick_compiling.py", line {line}:.*def wrong\(x\)'):
        compiled(wrong)(1.0)


KERNELS = {"kernel", "block", "entry", "run_entry"}


def assignments_to_parts(path):
    """Where kernels assign an array to a slice of another one that is not all of a row."""
    for function in ast.walk(ast.parse(path.read_text())):
        if not isinstance(function, ast.FunctionDef):
            continue
        if not KERNELS & {made.id for made in function.decorator_list if isinstance(made, ast.Name)}:
            continue
        for made in ast.walk(function):
            target = made.targets[0] if isinstance(made, ast.Assign) else None
            if not isinstance(target, ast.Subscript) or isinstance(made.value, ast.Constant):
                continue
            places = target.slice.elts if isinstance(target.slice, ast.Tuple) else [target.slice]
            slices = [place for place in places if isinstance(place, ast.Slice)]
            whole = len(places) == 1 and not any(place.lower or place.upper or place.step for place in slices)
            if slices and not whole:
                yield f"{path.name}:{made.lineno}"


def test_kernels_copy_whole_rows():
    """``a[i, :] = b`` and ``a[1:] = b`` take in numba's strings, for a message: 5 s in each block."""
    found = [place for path in Path(fricmb.__file__).parent.rglob("*.py") for place in assignments_to_parts(path)]
    assert not found
