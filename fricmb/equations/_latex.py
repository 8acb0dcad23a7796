"""Formulas typeset: SymPy's LaTeX, with the parts of an index apart by commas."""

from __future__ import annotations

import re
from typing import Any

import sympy

_INDEX = re.compile(r"_\{([^{}]+)\}")


def typeset(expression: Any) -> str:
    """LaTeX of an expression; ``F_lining_x`` has the index "lining, x", where SymPy puts a space that TeX drops."""
    return _INDEX.sub(lambda index: f"_{{{', '.join(index.group(1).split())}}}", sympy.latex(expression))
