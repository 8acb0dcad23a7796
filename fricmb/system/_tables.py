"""Building the tables of compiled templates that an integrator reads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fricmb.integrate.problem import Templates

#: Kinds of entries of X = [t, q, v, u, u'].
TIME, Q, V, U, DU = range(5)
#: Address where there is no template.
NO_TEMPLATE = 0


@dataclass(frozen=True, slots=True)
class Argument:
    """A linear form in X: entries (kind, index, coefficient) and a constant."""

    entries: tuple[tuple[int, int, float], ...] = ()
    constant: float = 0.0


TIME_ARGUMENT = Argument(((TIME, 0, 1.0),))


@dataclass(frozen=True, slots=True)
class Row:
    """A linear form in degrees of freedom and signals: (index, coefficient) each, and a constant."""

    q: tuple[tuple[int, float], ...] = ()
    u: tuple[tuple[int, float], ...] = ()
    constant: float = 0.0

    def value(self) -> Argument:
        """The form itself as an argument."""
        return Argument((*((Q, i, c) for i, c in self.q), *((U, j, c) for j, c in self.u)), self.constant)

    def rate(self) -> Argument:
        """Its time derivative."""
        return Argument((*((V, i, c) for i, c in self.q), *((DU, j, c) for j, c in self.u)))

    def driven_rate(self) -> Argument:
        """The part of its time derivative that prescribed motions bring in."""
        return Argument(tuple((DU, j, c) for j, c in self.u))

    def extended(self, n: int) -> list[tuple[int, float]]:
        """Places in [dofs, signals] with coefficients."""
        return [*self.q, *((n + j, c) for j, c in self.u)]


@lru_cache(maxsize=64)
def _bare(address: tuple[int, ...]) -> Templates:
    """A table without numbers and arguments, such as that of contacts under constant forces."""
    count = len(address)
    starts = np.zeros(count + 1, dtype=np.int64)
    return Templates(address=np.array(address, dtype=np.int64), p_start=starts, x_start=starts)


class TableBuilder:
    """Collects templates one by one and packs them into a :class:`Templates`."""

    def __init__(self) -> None:
        self._address: list[int] = []
        self._p: list[float] = []
        self._p_start = [0]
        self._x_start = [0]
        self._arguments: list[Argument] = []

    def __len__(self) -> int:
        return len(self._address)

    def add(self, address: int, parameters: Iterable[float] = (), arguments: Sequence[Argument] = ()) -> None:
        """Append one template with its parameters and its arguments."""
        self._address.append(address)
        self._p.extend(float(p) for p in parameters)
        self._p_start.append(len(self._p))
        self._arguments.extend(arguments)
        self._x_start.append(len(self._arguments))

    def skip(self, count: int) -> None:
        """Append entries without a template."""
        self._address.extend([NO_TEMPLATE] * count)
        self._p_start.extend(self._p_start[-1:] * count)
        self._x_start.extend(self._x_start[-1:] * count)

    def build(self, n: int, n_u: int) -> Templates:
        """The packed table for n degrees of freedom and n_u signals."""
        if not self._address:
            return Templates()
        if not self._p and not self._arguments:
            return _bare(tuple(self._address))
        offset = (0, 1, 1 + n, 1 + 2 * n, 1 + 2 * n + n_u)
        entries = [entry for argument in self._arguments for entry in argument.entries]
        lengths = [len(argument.entries) for argument in self._arguments]
        return Templates(
            address=np.array(self._address, dtype=np.int64),
            p_start=np.array(self._p_start, dtype=np.int64),
            p=np.array(self._p, dtype=float),
            x_start=np.array(self._x_start, dtype=np.int64),
            form_start=np.concatenate([[0], np.cumsum(lengths, dtype=np.int64)]).astype(np.int64),
            form_index=np.array([offset[kind] + i for kind, i, _ in entries], dtype=np.int64),
            form_coefficient=np.array([c for _, _, c in entries], dtype=float),
            form_constant=np.array([argument.constant for argument in self._arguments], dtype=float),
        )
