"""The arrays of a mechanism: bodies that turn, joints as constraints, friction whose load is a reaction.

Beside the degrees of freedom q (n,) stand the *places* p = P(q), coordinates of points fixed in bodies.  Together they
are the extended coordinates y = [q, p], and everything that makes force sees y alone:

    M q'' = f_q + P_q^T f_p + G^T lam,   (f_q, f_p) = force(t, y, y', u, u') + friction
    0     = phi(t, q),                   G = d phi / dq

``X = [t, y (n_y), y' (n_y), u (n_u), u' (n_u)]`` is what arguments of templates are gathered from.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fricmb.integrate.problem import Codes, Floats, Ints, Templates, _f, _i

#: Value of ``hands_over`` of joints whose impacts are computed, and of ``dropped`` of those that are open.
RIGID, APART = 2, 2


@dataclass(frozen=True, kw_only=True)
class Entries:
    """A sparse matrix by its entries: ``row``, ``column`` (k,) and ``value`` (k,); repeated places add up."""

    row: Ints = field(default_factory=lambda: _i(0))
    column: Ints = field(default_factory=lambda: _i(0))
    value: Floats = field(default_factory=lambda: _f(0))

    @classmethod
    def of(cls, entries: list[tuple[int, int, float]]) -> Entries:
        """From triples, those of one place added up."""
        total: dict[tuple[int, int], float] = {}
        for i, j, value in entries:
            total[i, j] = total.get((i, j), 0.0) + value
        kept = [(i, j, value) for (i, j), value in sorted(total.items()) if value != 0.0]
        return cls(
            row=np.array([i for i, _, _ in kept], dtype=np.int64),
            column=np.array([j for _, j, _ in kept], dtype=np.int64),
            value=np.array([value for _, _, value in kept], dtype=float),
        )


@dataclass(frozen=True, kw_only=True)
class Places:
    """Points fixed in bodies.

    Attributes
    ----------
    address, p_start, p : as in Templates
        x = coordinates of the body (b,), out = [P (c), dP/dx (c x b), d2P/dx2 (c x b x b)].
    dof_start, dof : (k+1,) and (sum,) int64
        Degrees of freedom of the body that place i belongs to.
    first : (k+1,) int64
        Place i is the extended coordinates ``n + first[i]`` to ``n + first[i+1] - 1``.
    """

    address: Ints = field(default_factory=lambda: _i(0))
    p_start: Ints = field(default_factory=lambda: _i(1))
    p: Floats = field(default_factory=lambda: _f(0))
    dof_start: Ints = field(default_factory=lambda: _i(1))
    dof: Ints = field(default_factory=lambda: _i(0))
    first: Ints = field(default_factory=lambda: _i(1))


@dataclass(frozen=True, kw_only=True)
class Joints:
    """Constraints, joint by joint.

    Attributes
    ----------
    table : Templates
        x = [x (n_x), x' (n_x), lam (m)]; the linear forms give x and x', lam follows.  out = [phi (m), dphi/dx (m n_x),
        sum lam d2phi/dx2 (n_x n_x), x'^T d2phi/dx2 (m n_x)] and, of a joint with friction in d directions, [s (d n_x),
        ds/dx (d n_x n_x), N, dN/dlam (m), dN/dx (n_x), dN/dx' (n_x)]: slip velocities are s_k . x', the normal force
        N(x, x', lam).  A joint without rows (m = 0) holds nothing; its friction is open where N < 0.
    row : (k+1,) int64
        Joint i owns the multipliers ``row[i]:row[i+1]``.
    load_of : (k,) int64
        The joint whose multipliers are the ``lam`` of joint i: itself; of a joint without rows that rubs as another
        one is pressed, that one.  Empty: each its own.
    port : (k,) int64
        Its friction among the contacts of the problem, or -1.
    one_sided : (k,) int8
        1: its single multiplier pushes only (lam >= 0); where it would pull, contact is lost.
    hands_over : (k,) int8
        1: where contact is lost the joint opens and the run goes on.  2: as well, and impacts are computed.
    inner : (k,) int8
        1: what ties the coordinates of one body together, named after it.  It holds no part to another, and reactions
        and reports leave it out.
    restitution, tangential : (k,)
        Coefficients of restitution along the normal and along slip; nan where impacts are not computed.
    mu_impact : (k,)
        Coefficient of friction in impacts; nan: that of slip.
    side : (k,) int8
        Of a part with two ends, which become two joints, -1 for the lower and 1 for the upper one; else 0.
    names : tuple of str
    dropped : (m,) int8
        1: a constraint that follows from the others; its multiplier is 0.  2: a joint that is open.
    """

    table: Templates = field(default_factory=Templates)
    row: Ints = field(default_factory=lambda: _i(1))
    load_of: Ints = field(default_factory=lambda: _i(0))
    port: Ints = field(default_factory=lambda: _i(0))
    one_sided: Codes = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    hands_over: Codes = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    inner: Codes = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    restitution: Floats = field(default_factory=lambda: _f(0))
    tangential: Floats = field(default_factory=lambda: _f(0))
    mu_impact: Floats = field(default_factory=lambda: _f(0))
    side: Codes = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    names: tuple[str, ...] = ()
    dropped: Codes = field(default_factory=lambda: np.zeros(0, dtype=np.int8))

    def owners(self, rows: Ints) -> Ints:
        """Joint that each of some rows belongs to."""
        return np.asarray(np.searchsorted(self.row, rows, side="right") - 1, dtype=np.int64)


def loads_of(joints: Joints) -> Ints:
    """``load_of`` of every joint."""
    return joints.load_of if joints.load_of.size else np.arange(len(joints.port), dtype=np.int64)


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """All of it; contacts, elements and signals of the problem see extended coordinates.

    Attributes
    ----------
    n, n_places : int
        Degrees of freedom and further extended coordinates.
    M : Entries
        Mass matrix over the degrees of freedom.
    least_mass : (n,) or (0,)
        What changes of a coordinate are measured by where its own mass is less: an axis of a flat body has none.
    K, C, B : Entries
        Stiffness and damping over [y, u]; force on y per unit of signal.
    f : (n_y + n_u,)
        Constant force.
    places, joints : Places, Joints
    slip : Templates
        Of every contact that is no joint the form of its slip velocity (address 0; one form an entry), of others an
        empty one.
    poisson : bool
        Whether impacts obey Poisson's law in place of Newton's.
    in_turn : bool
        Whether impacts at one instant are taken one after another.
    jumps : bool
        Whether an impact without collision goes on where no forces fit.
    """

    n: int
    n_places: int
    M: Entries
    K: Entries
    C: Entries
    B: Entries
    f: Floats
    places: Places
    joints: Joints
    slip: Templates
    least_mass: Floats = field(default_factory=lambda: _f(0))
    poisson: bool = False
    in_turn: bool = False
    jumps: bool = False

    @property
    def has_impacts(self) -> bool:
        """Whether something is rigid and may be hit."""
        return bool((self.joints.hands_over == RIGID).any())

    @property
    def n_y(self) -> int:
        """Number of extended coordinates."""
        return self.n + self.n_places

    @property
    def n_rows(self) -> int:
        """Number of multipliers."""
        return int(self.joints.row[-1])
