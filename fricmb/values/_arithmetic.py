"""Operators of what stands for a SymPy expression in declarations."""

from __future__ import annotations

from typing import Any


class Arithmetic:
    """Combines with numbers and expressions as the expression of ``_sympy_`` does; a combination is an expression."""

    # numpy leaves `array * parameter` to the methods below
    __array_ufunc__ = None

    def _sympy_(self) -> Any:
        raise NotImplementedError

    def __neg__(self) -> Any:
        return -self._sympy_()

    def __pos__(self) -> Any:
        return self._sympy_()

    def __abs__(self) -> Any:
        return abs(self._sympy_())

    def __add__(self, other: Any) -> Any:
        return self._sympy_() + other

    def __radd__(self, other: Any) -> Any:
        return other + self._sympy_()

    def __sub__(self, other: Any) -> Any:
        return self._sympy_() - other

    def __rsub__(self, other: Any) -> Any:
        return other - self._sympy_()

    def __mul__(self, other: Any) -> Any:
        return self._sympy_() * other

    def __rmul__(self, other: Any) -> Any:
        return other * self._sympy_()

    def __truediv__(self, other: Any) -> Any:
        return self._sympy_() / other

    def __rtruediv__(self, other: Any) -> Any:
        return other / self._sympy_()

    def __pow__(self, other: Any) -> Any:
        return self._sympy_() ** other

    def __rpow__(self, other: Any) -> Any:
        return other ** self._sympy_()
