"""Formulas typeset: SymPy's LaTeX, with the parts of an index apart by commas."""

from __future__ import annotations

import re
from typing import Any

import sympy

_INDEX = re.compile(r"_\{([^{}]+)\}")
#: A name of more than one letter, such as a parameter's.
_WORD = re.compile(r"[A-Za-z]{2,}")


def typeset(expression: Any) -> str:
    """LaTeX of an expression; ``F_lining_x`` has the index "lining, x", where SymPy puts a space that TeX drops."""
    words = {symbol: rf"\mathrm{{{symbol.name}}}" for symbol in _symbols(expression) if _WORD.fullmatch(symbol.name)}
    latex = sympy.latex(expression, symbol_names=words)
    return _INDEX.sub(lambda index: f"_{{{', '.join(index.group(1).split())}}}", latex)


def _symbols(expression: Any) -> set[Any]:
    """Symbols whose names SymPy would set as a product of letters: "load"; Greek letters and marks have a command."""
    free: set[Any] = getattr(expression, "free_symbols", set())
    return {symbol for symbol in free if "\\" not in sympy.latex(symbol)}
