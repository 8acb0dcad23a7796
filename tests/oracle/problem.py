"""What the oracle is given: numbers and functions of numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

STICK, SLIP, OPEN = 0, 1, 2


class OracleError(Exception):
    """The oracle cannot say what happens (it stops; it never guesses)."""


def nothing(t: float) -> float:
    """0 at all times."""
    return 0.0


class NoLoad(OracleError):
    """Loads and the friction that they cause do not settle each other."""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """One contact: relative velocity ``g = W^T v - slide(t)``, and either a cone or a smooth law.

    ``mu(r, N)`` the coefficient in slip, ``mu_s(N)`` that of break-away.  A smooth law has ``force(g, N, z)`` (and
    ``rate(g, N, z)``, ``n_z`` states) in their place.  ``N(t, q, v)`` may come out negative: the contact is open then.
    """

    name: str
    W: np.ndarray
    N: Callable[[float, np.ndarray, np.ndarray], float]
    mu: Callable[[float, float], float] | None = None
    mu_s: Callable[[float], float] | None = None
    force: Callable[..., np.ndarray] | None = None
    rate: Callable[..., np.ndarray] | None = None
    n_z: int = 0
    reaction: Callable[[float, np.ndarray, np.ndarray, np.ndarray], float] | None = None
    """The load from the accelerations, in place of N (a dry pin)."""
    slide: Callable[[float], Any] = nothing
    slide_rate: Callable[[float], Any] = nothing
    constant: bool = True
    """Whether N never changes; of a reaction: whether nothing ends where it falls to 0."""

    @property
    def d(self) -> int:
        """Number of tangential directions."""
        return self.W.shape[1]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """M q'' + C q' + K q = load(t) + extra(t, q, v) + friction; ``mass(q)`` in place of M where it varies.

    ``slip(q)`` holds W of all contacts side by side where it varies, and ``slip_rate(q, v)`` is ``W'^T v`` then.

    Functions of time are continuous from the right; ``breaks`` are the times at which anything jumps or has a kink.
    """

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    q: np.ndarray
    v: np.ndarray
    contacts: tuple[Contact, ...]
    t_end: float
    load: Callable[[float], Any] = nothing
    extra: Callable[[float, np.ndarray, np.ndarray], np.ndarray] | None = None
    mass: Callable[[np.ndarray], np.ndarray] | None = None
    slip: Callable[[np.ndarray], np.ndarray] | None = None
    slip_rate: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None
    breaks: tuple[float, ...] = ()
    scale: float = 1.0
    """A typical speed; times 1e-12 it is nothing."""
    max_step: float | None = None


@dataclass
class Transition:
    """A change of mode."""

    t: float
    contact: str
    kind: str


@dataclass
class Motion:
    """What the oracle found: pieces of dense output, transitions and how near it came to a decision."""

    n: int
    pieces: list[tuple[float, float, Any]] = field(default_factory=list)
    events: list[Transition] = field(default_factory=list)
    ambiguous: bool = False
    """Whether more than one set of modes with the most contacts stuck was consistent at some instant."""
    closest: float = np.inf
    """The smallest slip speed passed in two directions without sticking, over ``scale``."""
    last: np.ndarray | None = None

    def __call__(self, t: np.ndarray) -> np.ndarray:
        """Positions, velocities and states at times ``t``, one column each (at a jump: before it)."""
        t = np.atleast_1d(t)
        assert self.last is not None
        out = np.empty((self.last.size, t.size))
        ends = np.array([piece[1] for piece in self.pieces])
        at = np.minimum(np.searchsorted(ends, t), len(ends) - 1)
        for k in np.unique(at):
            out[:, at == k] = self.pieces[k][2](t[at == k])
        return out
