"""Values of declarations: numbers, named parameters, expressions, and how they are checked, listed and replaced."""

from fricmb.values._arithmetic import Arithmetic
from fricmb.values._asked import ask, expressions, one_expression
from fricmb.values._declaration import Declaration
from fricmb.values._held import Held, held, is_foreign
from fricmb.values._hertz import Hz
from fricmb.values._in_symbols import in_symbols
from fricmb.values._numbers import (
    Number,
    as_float,
    depth_of,
    has_entries,
    is_expression,
    is_flag,
    is_list,
    is_one_of,
    is_plain,
    is_sparse,
    parameters_in,
    substitute,
    value_of,
)
from fricmb.values._parameter import Parameter, parameter
from fricmb.values._standin import Symbolic, symbolic
from fricmb.values._units import DIMENSIONLESS, DIMENSIONS, SI, Units
from fricmb.values._words import counted

__all__ = [
    "DIMENSIONLESS",
    "DIMENSIONS",
    "SI",
    "Arithmetic",
    "Declaration",
    "Held",
    "Hz",
    "Number",
    "Parameter",
    "Symbolic",
    "Units",
    "as_float",
    "ask",
    "counted",
    "depth_of",
    "expressions",
    "has_entries",
    "held",
    "in_symbols",
    "is_expression",
    "is_flag",
    "is_foreign",
    "is_list",
    "is_one_of",
    "is_plain",
    "is_sparse",
    "one_expression",
    "parameter",
    "parameters_in",
    "substitute",
    "symbolic",
    "value_of",
]
