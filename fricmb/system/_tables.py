"""Building the tables of compiled templates that an integrator reads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate

import numpy as np

from fricmb.integrate.problem import Ints, Templates

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
        #: Address, parameters and arguments of each.
        self.entries: list[tuple[int, tuple[float, ...], tuple[Argument, ...]]] = []

    def __len__(self) -> int:
        return len(self.entries)

    def add(self, address: int, parameters: Iterable[float] = (), arguments: Sequence[Argument] = ()) -> None:
        """Append one template with its parameters and its arguments."""
        self.entries.append((address, tuple([float(p) for p in parameters]), tuple(arguments)))

    def skip(self, count: int) -> None:
        """Append entries without a template."""
        self.entries.extend([_NOTHING] * count)

    def build(self, n: int, n_u: int) -> Templates:
        """The packed table for n degrees of freedom and n_u signals."""
        if not self.entries:
            return _NO_TABLE
        address, numbers, given = zip(*self.entries, strict=True)
        if not any(numbers) and not any(given):
            return _bare(address)
        offset = (0, 1, 1 + n, 1 + 2 * n, 1 + 2 * n + n_u)
        arguments = [argument for held in given for argument in held]
        entries = [entry for argument in arguments for entry in argument.entries]
        return Templates(
            address=np.array(address, dtype=np.int64),
            p_start=starts(numbers),
            p=np.array([p for held in numbers for p in held], dtype=float),
            x_start=starts(given),
            form_start=starts([argument.entries for argument in arguments]),
            form_index=np.array([offset[kind] + i for kind, i, _ in entries], dtype=np.int64),
            form_coefficient=np.array([c for _, _, c in entries], dtype=float),
            form_constant=np.array([argument.constant for argument in arguments], dtype=float),
        )


#: A table without entries.
_NO_TABLE = Templates()
#: An entry without a template.
_NOTHING: tuple[int, tuple[float, ...], tuple[Argument, ...]] = (NO_TEMPLATE, (), ())


def starts(held: Iterable[Sequence[object]]) -> Ints:
    """Where each of several sequences begins, one behind the other, and their length."""
    return np.array([0, *accumulate([len(sequence) for sequence in held])], dtype=np.int64)
