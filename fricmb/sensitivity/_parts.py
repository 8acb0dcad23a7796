"""Forces of the parts of a scene at many times with their slopes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn, Protocol

import numpy as np

from fricmb import stated
from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene import Body, Force, Gravity, MatrixElement, ModalBody, RigidBody, SpaceBody, modal_matrices
from fricmb.scene._offset import CentreForce
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._found import Found
from fricmb.sensitivity._functions import Function
from fricmb.sensitivity._motions import Given, Moment
from fricmb.sensitivity._seeds import Seeds
from fricmb.values import value_of


class Acting(Protocol):
    """A part that acts on degrees of freedom; ``seeded``: a parameter is one of its numbers."""

    seeded: bool

    def add(self, moment: Moment, found: Found) -> None:
        """Put its share into what is found."""

    def is_linear(self, moment: Moment) -> bool:
        """Whether forces are linear in the degrees of freedom, with coefficients that time does not change."""


class Acts:
    """A force element."""

    def __init__(self, element: Any, seeds: Seeds) -> None:
        self.forms = element.local_coordinates()
        self.function = Function(stated.element(element, len(self.forms)))
        self.numbers = seeds.numbers(element, f"{element.name}.")
        self.label = element._label()
        self.seeded = any(number.slopes for number in self.numbers)

    def add(self, moment: Moment, found: Found) -> None:
        """Its forces."""
        motions = [moment.form(form) for form in self.forms]
        arguments = [m.position for m in motions] + [m.rate for m in motions] + [moment.time, *self.numbers]
        for motion, force in zip(motions, self.function(arguments), strict=True):
            found.push(motion.row, force)


    def is_linear(self, moment: Moment) -> bool:
        """Whether what it states is, and its ends are driven by nothing."""
        motions = [moment.form(form) for form in self.forms]
        if any(isinstance(c, Dual) for m in motions for _, c in m.row):
            return False
        by = {j for m in motions for j in (*m.position.slopes, *m.rate.slopes)}
        if max(by, default=0) >= 2 * moment.frame.n:
            return False
        time = 2 * len(self.forms)
        zeros = [time + 1 + i for i, x in enumerate(self.numbers) if x.value == 0.0 and not x.slopes]
        return self.function.is_linear(time, tuple(zeros))


class Pushes:
    """A force that is given."""

    def __init__(self, part: Force, seeds: Seeds) -> None:
        self.form = part.local_coordinates()[0]
        self.value = Given(part.value, f"{part.name}.value", seeds)
        self.seeded = self.value.number is not None and bool(self.value.number.slopes)

    def is_linear(self, moment: Moment) -> bool:
        """Whether it is constant."""
        turns = any(isinstance(c, Dual) for _, c in moment.form(self.form).row)
        return self.value.number is not None and not turns

    def add(self, moment: Moment, found: Found) -> None:
        """The force on its body."""
        found.push(moment.form(self.form).row, self.value.at(moment))


class Leans:
    """The centre of a cone under a normal force that is an expression: an offset times what stands beside it."""

    def __init__(self, part: CentreForce, seeds: Seeds) -> None:
        self.form = part.local_coordinates()[0]
        self.offset, self.pressing = seeds.dual(part.offset, part.slot), Given(part.per_offset, "", seeds)
        self.seeded = bool(self.offset.slopes)

    def is_linear(self, moment: Moment) -> bool:
        """The normal force is an expression."""
        return False

    def add(self, moment: Moment, found: Found) -> None:
        """The force on its body."""
        found.push(moment.form(self.form).row, self.offset.times(self.pressing.at(moment)))


class Vibrates:
    """Stiffness and damping (2, k, k) of a modal body, or of matrices, on rows of q and v; ``slopes`` by column."""

    def __init__(self, rows: list[int], matrices: Floats, slopes: dict[int, Floats]) -> None:
        self.rows, self.matrices, self.slopes = np.array(rows, dtype=np.int64), matrices, slopes
        self.seeded = bool(slopes)

    def add(self, moment: Moment, found: Found) -> None:
        """Their forces."""
        y = np.stack([moment.q[self.rows], moment.v[self.rows]])
        found.force[self.rows] -= (self.matrices @ y).sum(axis=0)
        for part, a, b in zip(*np.nonzero(self.matrices), strict=True):
            column = int(part) * moment.frame.n + int(self.rows[b])
            found.add_slope(int(self.rows[a]), column, -self.matrices[part, a, b])
        for j, matrices in self.slopes.items():
            for row, force in zip(self.rows.tolist(), (matrices @ y).sum(axis=0), strict=True):
                found.add_slope(row, j, -force)

    def is_linear(self, moment: Moment) -> bool:
        """It is."""
        return True


def _dense(matrix: Any, size: int) -> Floats:
    """A matrix, or a diagonal, or nothing, as an array (size, size)."""
    if matrix is None:
        return np.zeros((size, size))
    found: Floats = np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else value_of(matrix), dtype=float)
    return np.diag(found) if found.ndim == 1 else found


def _vibrating(part: Any) -> Floats:
    """Stiffness and damping (2, k, k) of a part."""
    size = len(part.dof_names if isinstance(part, ModalBody) else part.dofs)
    K, C = modal_matrices(part)[1:] if isinstance(part, ModalBody) else (part.scaled("K"), part.scaled("C"))
    return np.stack([_dense(K, size), _dense(C, size)])


def _inertia(part: Any) -> Floats:
    """Masses (k, k) of a part that is given by modes, matrices, or in space."""
    if isinstance(part, SpaceBody):
        return np.diag(np.asarray(part.masses(), dtype=float))
    return np.diag(modal_matrices(part)[0]) if isinstance(part, ModalBody) else _dense(part.scaled("M"), len(part.dofs))


def _slopes(part: Any, seeds: Seeds, values: Callable[[Any], Floats]) -> dict[int, Floats]:
    """Slopes of numbers of a part by the columns of parameters that its entries hold."""
    found = {j: np.sum([weight * values(one) for weight, one in own], axis=0) for j, own in seeds.varied(part).items()}
    return {j: slope for j, slope in found.items() if slope.any()}


class Falls:
    """Weight."""

    def __init__(self, scene: Any, gravity: Gravity, index: dict[str, int], seeds: Seeds) -> None:
        self.pull: list[tuple[int, Dual]] = []
        for body in scene.bodies:
            for letter, value in gravity.acceleration.items() if isinstance(body, Body | RigidBody | SpaceBody) else ():
                i = index.get(f"{body.name}.{letter}")
                if i is not None:
                    mass = seeds.dual(body.mass, f"{body.name}.mass")
                    self.pull.append((i, mass.times(seeds.dual(value, f"{gravity.name}.acceleration.{letter}"))))
        self.seeded = any(force.slopes for _, force in self.pull)

    def is_linear(self, moment: Moment) -> bool:
        """It is constant."""
        return True

    def add(self, moment: Moment, found: Found) -> None:
        """Weight of the bodies."""
        for i, force in self.pull:
            found.push([(i, 1.0)], force)


def masses(
    scene: Any, parts: set[str], index: dict[str, int], seeds: Seeds
) -> tuple[Floats, list[tuple[int, int, int, float]], Floats]:
    """The mass matrix (n, n), its slopes as (row, column, column of a parameter, slope), and what changes count by.

    That is the mass matrix too, but above 0 where a coordinate of a body in space has no mass.
    """
    M, seeded = np.zeros((len(index), len(index))), []
    weights = np.zeros(len(index))
    for part in scene.parts:
        if isinstance(part, Body | RigidBody):
            for name, mass in _masses(part, seeds):
                if name in index:
                    i = index[name]
                    M[i, i] += mass.value
                    seeded += [(i, i, j, slope) for j, slope in mass.slopes.items()]
            continue
        if isinstance(part, MatrixElement) and (part.M is None or part.name not in parts):
            continue
        if isinstance(part, ModalBody | SpaceBody | MatrixElement):
            names = part.dofs if isinstance(part, MatrixElement) else part.dof_names
            own = [k for k, name in enumerate(names) if name in index]
            at = np.array([index[names[k]] for k in own], dtype=np.int64)
            M[np.ix_(at, at)] += _inertia(part)[np.ix_(own, own)]
            for column, slopes in _slopes(part, seeds, _inertia).items():
                held = slopes[np.ix_(own, own)]
                seeded += [(int(at[a]), int(at[b]), column, held[a, b]) for a, b in zip(*np.nonzero(held), strict=True)]
            if isinstance(part, SpaceBody):
                weights[at] = np.asarray(part.least_masses(), dtype=float)[own]
    lacking = np.maximum(weights - np.diag(M), 0.0)
    return M, seeded, M + np.diag(lacking)


def _masses(part: Body | RigidBody, seeds: Seeds) -> list[tuple[str, Dual]]:
    """What each degree of freedom of a body has to move."""
    mass = seeds.dual(part.mass, f"{part.name}.mass")
    if isinstance(part, Body):
        return [(name, mass) for name in part.dof_names]
    inertia = seeds.dual(part.inertia, f"{part.name}.inertia")
    return list(zip(part.dof_names, (mass, mass, inertia), strict=True))


def acting(scene: Any, part: Any, index: dict[str, int], seeds: Seeds) -> Acting | None:
    """A part other than a contact as forces; None for one that only carries masses or a motion."""
    if isinstance(part, CentreForce):
        return Leans(part, seeds)
    if isinstance(part, Force):
        return Pushes(part, seeds)
    if isinstance(part, Gravity):
        return Falls(scene, part, index, seeds)
    if isinstance(part, ModalBody | MatrixElement):
        names = part.dof_names if isinstance(part, ModalBody) else part.dofs
        own = [k for k, name in enumerate(names) if name in index]
        places = np.ix_(range(2), own, own)
        matrices = _vibrating(part)[places]
        slopes = {j: slope[places] for j, slope in _slopes(part, seeds, _vibrating).items()}
        return Vibrates([index[names[k]] for k in own], matrices, slopes) if matrices.any() or slopes else None
    return Acts(part, seeds) if hasattr(part, "local_coordinates") else None


def refuse(part: Any, what: str) -> NoReturn:
    """Say what is not covered."""
    raise SceneError(f"sensitivities: {type(part).__name__} {part.name!r}: {what} is not covered")
