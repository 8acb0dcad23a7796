"""Errors of formulas that an author wrote for numbers: ``define_...`` methods are called with SymPy symbols."""

from __future__ import annotations

import re
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType

from fricmb.errors import FricmbError

#: Functions of ``math`` and numpy by their names in SymPy, where those differ.
_OTHERWISE = {
    "arccos": "acos", "arccosh": "acosh", "arcsin": "asin", "arcsinh": "asinh", "arctan": "atan", "arctan2": "atan2",
    "arctanh": "atanh", "absolute": "Abs", "fabs": "Abs", "abs": "Abs", "maximum": "Max", "minimum": "Min",
    "power": "Pow", "pow": "Pow", "sign": "sign", "copysign": "sign", "where": "Piecewise", "clip": "Max",
}  # fmt: skip
_LIBRARIES = ("sympy", "numpy", "numba", "mpmath")


@contextmanager
def in_symbols(error: type[FricmbError], label: str, method: str) -> Iterator[None]:
    """Turn what SymPy and numpy say of a formula for numbers into an error that names the author and the cure.

    Parameters
    ----------
    error : type
        The error to raise: ``LawError``, ``SceneError``.
    label : str
        The law or part, as its other errors name it.
    method : str
        The method that holds the formula, ``"define_coefficient"``.

    Raises
    ------
    FricmbError
        Of the given type, where the formula needs numbers.
    """
    try:
        yield
    except (TypeError, AttributeError) as raised:
        cure = _cure(raised)
        if cure is None:
            raise
        line = _line_of_author(raised.__traceback__)
        raise error(f"{label}: {method} is called with SymPy symbols; {cure}{line}") from raised


def _cure(raised: Exception) -> str | None:
    """What to write instead, or None where the error is of another kind."""
    text = str(raised)
    if "truth value of Relational" in text:
        return "a comparison has no truth value: write sympy.Piecewise((value, condition), ...), sympy.Max or sympy.Min"
    if re.search(r"operand.*'tuple'|multiply sequence", text):
        return "its arguments are tuples, one entry a direction or coordinate: write tuple(-k * c for c in v)"
    function = re.search(r"no callable (\w+) method", text)
    if function is None and "Cannot convert expression to float" not in text:
        return None
    line = _source(raised.__traceback__) or ""
    called = re.search(r"\b(math|np|numpy)\.(\w+)", line)
    if called is None and function is None and re.search(r"\b(float|int|round)\(", line):
        return "float() takes numbers alone: leave the expression as it is"
    name = function.group(1) if function else (called.group(2) if called else "exp")
    shown = called.group(0) if called else ("a function of numpy" if function else "a function of math")
    return f"{shown} takes numbers alone: write sympy.{_OTHERWISE.get(name, name)}"


def _frames(trace: TracebackType | None) -> list[traceback.FrameSummary]:
    frames = traceback.extract_tb(trace)
    return [f for f in frames if not any(part in _LIBRARIES for part in Path(f.filename).parts)]


def _source(trace: TracebackType | None) -> str | None:
    frames = _frames(trace)
    return frames[-1].line if frames else None


def _line_of_author(trace: TracebackType | None) -> str:
    frames = _frames(trace)
    if not frames or not frames[-1].line:
        return ""
    return f" (line {frames[-1].lineno}: {frames[-1].line})"
