"""The arrays an integrator sees, and all it sees: a scene reduced to its mathematics.

Notation of the docs: q, v (n,) degrees of freedom; u (n_u,) prescribed signals of time with their first and second
derivative; z (n_z,) internal states of laws; m tangential rows of all contacts together.

    M v' = -K q - C v - K_u u - C_u u' + f + B u  +  elements(t, q, v, u, u')  +  W F  +  Wn (N - N0)
    g    = W^T v - w - Wu u'                 relative velocity of every contact, row by row
    N_k  = max(0, normal_k(t, q, v, u, u'))  or a constant

A *template* is a compiled function ``void(x*, p*, out*)`` on float64 pointers, given by its address; what x and out
hold is stated where it is used.  ``X = [t, q (n), v (n), u (n_u), u' (n_u)]`` is the vector that ``x`` is gathered
from.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.csr import Csr, LazyMatrices
from fricmb.integrate.once_per import Kept, once_per

if TYPE_CHECKING:
    from fricmb.integrate.mechanism import Mechanism

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Codes = NDArray[np.int8]
Pivots = NDArray[np.int32]
Complexes = NDArray[np.complex128]
Complexes2 = NDArray[np.complex128]
Complexes3 = NDArray[np.complex128]
#: The same with the number of axes said: what the types of rooms and blocks are read from.
Floats2 = NDArray[np.float64]
Floats3 = NDArray[np.float64]
Floats4 = NDArray[np.float64]
Codes2 = NDArray[np.int8]

#: Contact modes; the sign of one-dimensional slip is the direction n.
STICK, SLIP, OPEN = 0, 1, 2
#: Kinds of law: constant mu_s and mu_0; coefficient mu(r, N); smooth force F(v, N, z), which never sticks.
LAW_CONSTANT, LAW_COEFFICIENT, LAW_SMOOTH = 0, 1, 2
#: Kinds of normal force: constant; an expression that acts on nobody; a law whose force both bodies feel; the reaction
#: of a joint.
NORMAL_CONSTANT, NORMAL_EXPRESSION, NORMAL_LAW, NORMAL_REACTION = 0, 1, 2, 3


def _f(*shape: int) -> Floats:
    return np.zeros(shape)


def _i(*shape: int) -> Ints:
    return np.zeros(shape, dtype=np.int64)


@dataclass(frozen=True, kw_only=True)
class Templates:
    """A table of compiled local functions with the places of their arguments.

    Attributes
    ----------
    address : (k,) int64
        Of the compiled ``void(x*, p*, out*)``; 0 where there is none.
    p_start, p : (k+1,) int64 and (sum,) float64
        Function i reads the block of parameters from ``p_start[i]`` on.
    x_start : (k+1,) int64
        Function i has the arguments ``x_start[i]:x_start[i+1]``; each is a linear form in X (a coordinate, an
        elongation, the motion of a point of a modal body):
    form_start, form_index, form_coefficient, form_constant : (n_x+1,) int64, (sum,) int64, (sum,), (n_x,)
        ``x[a] = form_constant[a] + sum(form_coefficient[j] * X[form_index[j]])``, j in
        ``form_start[a]:form_start[a+1]``.
    """

    address: Ints = field(default_factory=lambda: _i(0))
    p_start: Ints = field(default_factory=lambda: _i(1))
    p: Floats = field(default_factory=lambda: _f(0))
    x_start: Ints = field(default_factory=lambda: _i(1))
    form_start: Ints = field(default_factory=lambda: _i(1))
    form_index: Ints = field(default_factory=lambda: _i(0))
    form_coefficient: Floats = field(default_factory=lambda: _f(0))
    form_constant: Floats = field(default_factory=lambda: _f(0))


def _sparse_of(held: Kept, name: str) -> Csr:
    """A matrix as a sparse one, made once."""
    return once_per(held, ("sparse", name), lambda: Csr.of_dense(getattr(held, name)))


@dataclass(frozen=True, kw_only=True)
class Linear(Kept):
    """The constant part of the structure.

    Drivers (prescribed signals u) stand beside the dofs: row and column blocks [dofs, signals].

    Attributes
    ----------
    M : (n, n)
        Symmetric positive definite mass matrix.
    Kx, Cx : (n+n_u, n+n_u)
        Stiffness and damping between dofs and drivers.  ``Kx`` may be non-symmetric on the dofs.
    fx : (n+n_u,)
        Constant force (springs with a natural length, ...).
    B : (n, n_u)
        Force on the dofs per unit of signal, for forces that are functions of time alone.
    """

    M: Floats
    Kx: Floats
    Cx: Floats
    fx: Floats
    B: Floats

    def csr(self, name: str) -> Csr:
        """``M``, ``Kx``, ``Cx`` or ``B`` as a sparse matrix."""
        return _sparse_of(self, name)


class SparseLinear(LazyMatrices, Linear):
    """The same of a large scene: sparse, and dense only for those who ask for ``M``, ``Kx``, ``Cx`` or ``B``."""

    def __init__(self, *, M: Csr, Kx: Csr, Cx: Csr, fx: Floats, B: Csr) -> None:
        object.__setattr__(self, "_held", {"M": M, "Kx": Kx, "Cx": Cx, "B": B})
        object.__setattr__(self, "fx", fx)

    def csr(self, name: str) -> Csr:
        """``M``, ``Kx``, ``Cx`` or ``B`` as it is held."""
        return self._held[name]


@dataclass(frozen=True, kw_only=True)
class Input:
    """A function of time alone that acts in a problem.

    Attributes
    ----------
    tape : tuple of tuple, or None
        Its operations: see :mod:`fricmb.integrate.signals.jets`.
    parameters : tuple of float
    function : callable, optional
        Of the parameters followed by time: what has no tape is sampled.
    rates : int
        How many of its derivatives act as well: 1 for a position that is given.
    tables : tuple
        Series that it reads (:class:`~fricmb.integrate.signals.pieces.Table`): they live as long.
    """

    tape: tuple[tuple[Any, ...], ...] | None
    parameters: tuple[float, ...]
    function: Callable[[Sequence[float]], float] | None = None
    rates: int = 0
    tables: tuple[Any, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Signals:
    """Prescribed functions of time: template with x = [t], out = [u, u', u''].

    A signal of a driven body is its position, velocity and acceleration; of a time-dependent force the force as u; of a
    ``slide`` the slide velocity as u' (its u is unused).  ``breakpoints`` are stepped to exactly; integrators evaluate
    on the inner side of the interval between two of them.  ``uniform`` (n_u,): 1 where a signal is known to be linear
    in time (empty: nothing is known).  ``forces``: of each signal that is a force the whole function, for bounds (None
    where there are none).  ``kinks``: times at which functions of time are continuous and bend, to which
    steps go without anything else that is done at a breakpoint.  ``inputs``: all functions of time, those in normal
    forces and elements as well.
    """

    table: Templates = field(default_factory=Templates)
    breakpoints: Floats = field(default_factory=lambda: _f(0))
    uniform: Codes = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    inputs: tuple[Input, ...] = ()
    forces: tuple[Input | None, ...] = ()
    kinks: Floats = field(default_factory=lambda: _f(0))


@dataclass(frozen=True, kw_only=True)
class Contacts(Kept):
    """Contacts: rows of relative velocity, laws and normal forces.

    Attributes
    ----------
    row : (n_c+1,) int64
        Contact k owns the rows ``row[k]:row[k+1]`` (1 to 3) of ``W``, ``w``, ``Wu``.
    W : (n, m); w : (m,); Wu : (m, n_u)
        ``g = W.T v - w - Wu u'``; the force F on the rows acts as ``W F`` on the dofs.
    law : (n_c,) int8
        LAW_CONSTANT, LAW_COEFFICIENT (template x = [r, N], out = [mu, dmu/dr, dmu/dN], r >= 0) or
        LAW_SMOOTH (template x = [v (d), N, z (n_z)], out = [F (d), z' (n_z), Jacobian (d+n_z) x (d+1+n_z) by rows]).
    law_table : Templates
        One entry a contact (address 0 for LAW_CONSTANT); the linear forms are unused.
    mu_s, mu_0 : (n_c,)
        Break-away coefficient and limit of the slip coefficient for r -> 0 (``mu_k`` of a constant law).  The sign
        of ``mu_s`` is a flag: below 0 the contact breaks away at ``mu_0`` under the present normal force, and |mu_s| is
        what that is at the start.
    lean : (n_c,)
        How far the centre of a cone in one direction is off 0 while the contact sticks, over its limit: it sticks while
        ``|F + lean mu_s N| <= mu_s N``.  (Empty: all 0.)
    piecewise : (n_c,) bool
        Whether a law is a table or compiled by itself: its slope may jump, or what it is made of.
    knot_start : (n_c+1,) int64; knots : (sum,)
        Slip speeds, rising, at which the coefficient of contact k bends or goes over to another formula:
        ``knot_start[k]:knot_start[k+1]``; steps end there.  (An empty ``knot_start``: there are none.)
    z_start : (n_c+1,) int64
        Contact k owns the internal states ``z_start[k]:z_start[k+1]``.
    normal : (n_c,) int8
        NORMAL_CONSTANT, NORMAL_EXPRESSION, NORMAL_LAW or NORMAL_REACTION.
    straight : (n_c,) bool
        Whether the normal force is known to be linear in e and e' before it is cut at 0 (empty: nothing is known).
    N : (n_c,)
        The constant normal force; for the other kinds unused.
    normal_table : Templates
        One entry a contact (address 0 where constant): out = [N (before max with 0), dN/dx (n_x)].  For NORMAL_LAW
        x = [e, e'] (the distance along its axis and its rate) and out goes on with [V, dV/de], the potential of
        N - N0 at e' = 0.
    Wn : (n, n_c); N0 : (n_c,)
        Direction on the dofs in which ``N - N0`` acts (0 unless NORMAL_LAW).
    """

    row: Ints = field(default_factory=lambda: _i(1))
    W: Floats
    w: Floats
    Wu: Floats
    law: Codes = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    law_table: Templates = field(default_factory=Templates)
    mu_s: Floats = field(default_factory=lambda: _f(0))
    mu_0: Floats = field(default_factory=lambda: _f(0))
    lean: Floats = field(default_factory=lambda: _f(0))
    piecewise: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    knot_start: Ints = field(default_factory=lambda: _i(0))
    knots: Floats = field(default_factory=lambda: _f(0))
    z_start: Ints = field(default_factory=lambda: _i(1))
    normal: Codes = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    straight: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    N: Floats = field(default_factory=lambda: _f(0))
    normal_table: Templates = field(default_factory=Templates)
    Wn: Floats
    N0: Floats = field(default_factory=lambda: _f(0))

    def csr(self, name: str) -> Csr:
        """``W``, ``Wu`` or ``Wn`` as a sparse matrix."""
        return _sparse_of(self, name)

    @property
    def of_row(self) -> Ints:
        """(m,) the contact of every row."""
        return np.repeat(np.arange(len(self.row) - 1), np.diff(self.row))


class SparseContacts(LazyMatrices, Contacts):
    """The same of a large scene: ``W``, ``Wu``, ``Wn`` sparse, and dense only for those who ask for them."""

    def __init__(self, *, W: Csr, Wu: Csr, Wn: Csr, **others: Any) -> None:
        super().__init__(W=_NONE, Wu=_NONE, Wn=_NONE, **others)
        for name in ("W", "Wu", "Wn"):
            object.__delattr__(self, name)
        object.__setattr__(self, "_held", {"W": W, "Wu": Wu, "Wn": Wn})

    def csr(self, name: str) -> Csr:
        """``W``, ``Wu`` or ``Wn`` as it is held."""
        return self._held[name]


_NONE = np.zeros((0, 0))


@dataclass(frozen=True, kw_only=True)
class Elements:
    """Nonlinear elements: template out = [f (n_f), df/dx (n_f x n_x by rows), V, P_loss, P_input].

    V: stored energy; P_loss: dissipated power; P_input: power brought in (by a ``Force``: f.v; through a driven end:
    dV/du u' and the like).  Local force i of element k acts on the dofs by a linear form as well:

    Attributes
    ----------
    table : Templates
    f_start : (k+1,) int64
        Element k has the local forces ``f_start[k]:f_start[k+1]``.
    spread_start, spread_dof, spread_coefficient : (n_f+1,) int64, (sum,) int64, (sum,)
        Force b adds ``spread_coefficient[j] * f[b]`` to dof ``spread_dof[j]``.
    """

    table: Templates = field(default_factory=Templates)
    f_start: Ints = field(default_factory=lambda: _i(1))
    spread_start: Ints = field(default_factory=lambda: _i(1))
    spread_dof: Ints = field(default_factory=lambda: _i(0))
    spread_coefficient: Floats = field(default_factory=lambda: _f(0))


@dataclass(frozen=True, kw_only=True)
class Bends:
    """Functions of the motion at whose sign changes a force or a load jumps or has a kink; steps end there.

    Attributes
    ----------
    table : Templates
        Function i gives several: out = those from ``start[i]`` to ``start[i+1]``.
    start : (k+1,) int64
    """

    table: Templates = field(default_factory=Templates)
    start: Ints = field(default_factory=lambda: _i(1))


def _no_spectrum() -> tuple[Floats, Floats]:
    """Of what is no linear structure."""
    return _f(0), _f(0)


@dataclass(frozen=True, kw_only=True)
class Problem(Kept):
    """A scene as arrays: linear structure, signals, contacts, nonlinear elements; each but the first may be empty.

    ``spectrum``: what finds ``omega`` and ``zeta`` when they are asked for.  ``contact_names``, ``dof_names`` serve
    messages alone.  ``mechanism``: bodies that turn and joints; then ``linear`` is empty, and everything else sees
    extended coordinates (see :mod:`~fricmb.integrate.mechanism`).
    """

    linear: Linear
    signals: Signals
    contacts: Contacts
    elements: Elements
    spectrum: Callable[[], tuple[Floats, Floats]] = _no_spectrum
    bends: Bends = field(default_factory=Bends)
    dof_names: tuple[str, ...] = ()
    contact_names: tuple[str, ...] = ()
    mechanism: Mechanism | None = None

    @property
    def omega(self) -> Floats:
        """Angular frequencies of the linear structure without friction, rising; empty where they are not known."""
        return once_per(self, "spectrum", self.spectrum)[0]

    @property
    def zeta(self) -> Floats:
        """Its damping ratios."""
        return once_per(self, "spectrum", self.spectrum)[1]

    @property
    def n(self) -> int:
        """Number of degrees of freedom."""
        if self.mechanism is not None:
            return self.mechanism.n
        return len(self.linear.fx) - self.n_u

    @property
    def loads_bend(self) -> bool:
        """Whether some prescribed signal is not known to be linear in time."""
        uniform = self.signals.uniform
        return bool(self.n_u > 0 and not (uniform.size and uniform.all()))

    @property
    def n_u(self) -> int:
        """Number of prescribed signals."""
        return len(self.signals.table.address)

    @property
    def n_c(self) -> int:
        """Number of contacts."""
        return len(self.contacts.law)

    @property
    def m(self) -> int:
        """Number of tangential rows of all contacts."""
        return int(self.contacts.row[-1])

    @property
    def n_v(self) -> int:
        """Number of contacts whose normal force varies."""
        return int(np.count_nonzero(self.contacts.normal != NORMAL_CONSTANT))

    @property
    def n_z(self) -> int:
        """Number of internal states of laws."""
        return int(self.contacts.z_start[-1])


@dataclass(frozen=True, kw_only=True)
class Start:
    """Where a run starts.

    ``mode`` (n_c,) and ``direction`` (m,) (unit vector of slip on a contact's rows) are given when a run goes on from
    another; otherwise None and found from the accelerations where g = 0.
    """

    t: float
    q: Floats
    v: Floats
    z: Floats
    mode: Codes | None = None
    direction: Floats | None = None
