"""Forces of the parts of a scene at many times, in numpy, from what each part states in SymPy."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from fricmb import stated
from fricmb.equations import numbers
from fricmb.field._functions import Given, function
from fricmb.field._motions import Moment, Row
from fricmb.integrate.problem import Floats
from fricmb.scene import Body, Force, Gravity, Joint, MatrixElement, ModalBody, RigidBody, SpaceBody, modal_matrices
from fricmb.values import value_of


@dataclass(kw_only=True)
class Found:
    """What the parts say at the times of a moment.

    ``force`` (n, n_t) on the degrees of freedom; of contacts by number ``N`` (n_t,), slip velocity ``g`` (d, n_t), its
    ``rows``, law's ``rate`` (n_z, n_t); of joints constraints ``phi``, their rates ``phi_dot`` and ``phi_rows``.
    """

    force: Floats
    N: dict[int, Any] = field(default_factory=dict)
    g: dict[int, Floats] = field(default_factory=dict)
    rows: dict[int, list[Row]] = field(default_factory=dict)
    rate: dict[int, Floats] = field(default_factory=dict)
    phi: dict[str, Floats] = field(default_factory=dict)
    phi_dot: dict[str, Floats] = field(default_factory=dict)
    phi_rows: dict[str, list[Row]] = field(default_factory=dict)

    def push(self, row: Row, force: Any) -> None:
        """A force on a motion, to the degrees of freedom behind it."""
        for i, c in row:
            self.force[i] += c * force


class Acting(Protocol):
    """A part that acts on degrees of freedom."""

    def add(self, moment: Moment, found: Found) -> None:
        """Put its share into what is found."""


class Acts:
    """A force element.

    Parameters
    ----------
    element : Element
    """

    def __init__(self, element: Any) -> None:
        self.forms = element.local_coordinates()
        self.function = function(stated.element(element, len(self.forms)))
        self.numbers = numbers(element)

    def forces(self, moment: Moment) -> list[Any]:
        """Its force on each of its motions."""
        return self._forces(moment, [moment.form(form) for form in self.forms])

    def add(self, moment: Moment, found: Found) -> None:
        """Its forces."""
        motions = [moment.form(form) for form in self.forms]
        for (_, _, row), force in zip(motions, self._forces(moment, motions), strict=True):
            found.push(row, force)

    def _forces(self, moment: Moment, motions: list[tuple[Any, Any, Row]]) -> list[Any]:
        x, v = [m[0] for m in motions], [m[1] for m in motions]
        return list(self.function(*x, *v, moment.t, *self.numbers))


class Pushes:
    """A force that is given."""

    def __init__(self, part: Force) -> None:
        self.form = part.local_coordinates()[0]
        self.value = Given(part.value)

    def forces(self, moment: Moment) -> list[Any]:
        """Its one force."""
        return [self.value.at(moment)]

    def add(self, moment: Moment, found: Found) -> None:
        """The force on its body."""
        found.push(moment.form(self.form)[2], self.value.at(moment))


class Vibrates:
    """Stiffness and damping of a modal body, or of matrices, on rows of q and v."""

    def __init__(self, rows: list[int], K: Any, C: Any) -> None:
        self.rows, self.K, self.C = np.array(rows, dtype=np.int64), K, C

    def add(self, moment: Moment, found: Found) -> None:
        """Their forces."""
        for matrix, values in ((self.K, moment.q), (self.C, moment.v)):
            if matrix is not None:
                part = values[self.rows]
                found.force[self.rows] -= matrix[:, None] * part if np.ndim(matrix) == 1 else matrix @ part


class Falls:
    """Weight."""

    def __init__(self, pull: list[tuple[int, float]]) -> None:
        self.pull = pull

    def add(self, moment: Moment, found: Found) -> None:
        """Weight of the bodies."""
        for i, force in self.pull:
            found.force[i] += force


class Joins:
    """A joint: its constraints, reactions, and with friction its slip and load."""

    def __init__(self, joint: Joint, contact: int | None, own: int) -> None:
        self.name, self.contact, self.own = joint.name, contact, own
        self.forms = joint.local_coordinates()
        self.drives = [Drive(*drive) for drive in joint.drives()]
        self.count = len(self.forms) + len(self.drives)
        self.function = function(stated.joint(joint, self.count))
        self.n_slip = 0 if joint.friction is None else joint.slip_rows
        self.numbers = numbers(joint.bare())
        self.pressed = joint.loaded_by or joint.name
        self.one_sided, self.constrains, self.impact = joint.one_sided, joint.constrains, joint.impact

    def add(self, moment: Moment, found: Found) -> None:
        """Reactions of the run; what the constraints and the slip are."""
        motions: list[tuple[Any, Any, Row]] = [moment.form(form) for form in self.forms]
        motions += [(*drive.at(moment.t, moment.frame.breaks), []) for drive in self.drives]
        lam = moment.lam[self.name]
        pressed = moment.lam[self.pressed]
        values = self.function(*[m[0] for m in motions], *[m[1] for m in motions], *pressed, *self.numbers)
        shape, n, n_phi = moment.t.shape, self.count, len(lam)
        whole = [np.broadcast_to(np.asarray(value, dtype=float), shape) for value in values]
        rates = np.array([np.broadcast_to(m[1], shape) for m in motions])
        found.phi[self.name] = np.array(whole[: n_phi])
        gradient = np.array(whole[n_phi : n_phi * (1 + n)]).reshape(n_phi, n, moment.t.size)
        found.phi_dot[self.name] = (gradient * rates).sum(axis=1)
        rows = [_combined(motions, slopes) for slopes in gradient]
        found.phi_rows[self.name] = rows
        for row, push in zip(rows, lam, strict=True):
            found.push(row, push)
        if self.n_slip and self.contact is not None:
            *factors, load = whole[n_phi * (1 + n) :]
            slips = np.array(factors).reshape(self.n_slip, n, -1)
            load = load if self.constrains or self.pressed != self.name else np.maximum(load, 0.0)
            found.g[self.contact], found.N[self.contact] = (slips * rates).sum(axis=1), load
            found.rows[self.contact] = [_combined(motions, slip) for slip in slips]
            for i, row in enumerate(found.rows[self.contact]):
                found.push(row, moment.F[self.own + i])


def _combined(motions: list[tuple[Any, Any, Row]], slopes: Any) -> Row:
    return [(i, slope * c) for (_, _, row), slope in zip(motions, slopes, strict=True) for i, c in row]


def masses(scene: Any, parts: set[str], index: dict[str, int]) -> tuple[Floats, list[tuple[Any, Any]]]:
    """Diagonal masses (n,), and matrices (rows, M) beside them."""
    diagonal, matrices = np.zeros(len(index)), []
    for part in scene.parts:
        if isinstance(part, RigidBody):
            m, J = float(value_of(part.mass)), float(value_of(part.inertia))
            held = dict(zip(part.dof_names, (m, m, J), strict=True))
        elif isinstance(part, SpaceBody):
            held = dict(zip(part.dof_names, part.masses(), strict=True))
        elif isinstance(part, Body):
            held = dict.fromkeys(part.dof_names, float(value_of(part.mass)))
        elif isinstance(part, ModalBody):
            held = dict(zip(part.dof_names, modal_matrices(part)[0].tolist(), strict=True))
        elif isinstance(part, MatrixElement) and part.M is not None and part.name in parts:
            matrices.append((np.array([index[name] for name in part.dofs]), part.scaled("M")))
            continue
        else:
            continue
        for name, value in held.items():
            if name in index:
                diagonal[index[name]] += value
    return diagonal, matrices


def least_masses(scene: Any, index: dict[str, int]) -> Floats:
    """What coordinates of bodies in space count at least where changes are measured (n,)."""
    least = np.zeros(len(index))
    for body in scene.bodies:
        for name, value in zip(body.dof_names, body.least_masses(), strict=True) if isinstance(body, SpaceBody) else ():
            if name in index:
                least[index[name]] = value
    return least


def acting(scene: Any, part: Any, index: dict[str, int], contact: int | None, own: int) -> Acting | None:
    """A part other than a contact as forces; None for one that only carries masses or a motion.

    ``contact``, ``own``: of a joint with friction its place among the contacts, and the row of its friction.
    """
    if isinstance(part, Force):
        return Pushes(part)
    if isinstance(part, Gravity):
        return Falls(_pull(scene, part, index))
    if isinstance(part, Joint):
        return Joins(part, contact, own)
    if isinstance(part, ModalBody):
        built = [i for i, name in enumerate(part.dof_names) if name in index]
        _, stiffness, damping = modal_matrices(part)
        rows = [index[part.dof_names[i]] for i in built]
        return Vibrates(rows, stiffness[built], damping[np.ix_(built, built)] if damping.ndim == 2 else damping[built])
    if isinstance(part, MatrixElement):
        K, C = part.scaled("K"), part.scaled("C")
        return None if K is None and C is None else Vibrates([index[name] for name in part.dofs], K, C)
    return Acts(part) if hasattr(part, "local_coordinates") else None


def _pull(scene: Any, gravity: Gravity, index: dict[str, int]) -> list[tuple[int, float]]:
    found = []
    for body in scene.bodies:
        for letter, value in gravity.acceleration.items() if isinstance(body, Body | RigidBody | SpaceBody) else ():
            i = index.get(f"{body.name}.{letter}")
            if i is not None:
                found.append((i, float(value_of(body.mass)) * float(value_of(value))))
    return found


class Drive:
    """A prescribed function of time of a joint, and its rate."""

    def __init__(self, given: str, value: Any, start: float) -> None:
        self.integrated, self.start = given == "rate", start
        self.value, self.rate = Given(value), Given(value, order=1)

    def at(self, t: Floats, breaks: Floats) -> tuple[Any, Any]:
        """Value and rate (n_t,); ``breaks``: times at which functions of time jump."""
        if not self.integrated:
            return self.value.over(t) + self.start, self.rate.over(t)
        return self.start + _integral(self.value, t, breaks), self.value.over(t)


def _integral(value: Given, t: Floats, breaks: Floats) -> Floats:
    """The integral from 0 to each of t, by Gauss's rule on short stretches that no break lies in."""
    if value.number is not None:
        return value.number * t
    if not t.size:
        return np.zeros(0)
    low, high = min(0.0, float(t.min())), max(0.0, float(t.max()))
    inner = breaks[(breaks > low) & (breaks < high)]
    ends = np.unique(np.concatenate([np.linspace(low, high, 257), inner, t, [0.0]]))
    x, w = np.polynomial.legendre.leggauss(8)
    half = 0.5 * np.diff(ends)
    nodes = ends[:-1, None] + half[:, None] * (1.0 + x)
    sums = np.append(0.0, np.cumsum(half * (value.over(nodes) @ w)))
    found: Floats = sums[np.searchsorted(ends, t)] - sums[np.searchsorted(ends, 0.0)]
    return found
