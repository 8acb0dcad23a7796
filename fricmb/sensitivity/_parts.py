"""Forces of the parts of a scene at many times with their slopes."""

from __future__ import annotations

from typing import Any, NoReturn, Protocol

import numpy as np

from fricmb import stated
from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene import Body, Force, Gravity, MatrixElement, ModalBody, RigidBody, SpaceBody, modal_matrices
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._found import Found
from fricmb.sensitivity._functions import Function
from fricmb.sensitivity._motions import Given, Moment
from fricmb.sensitivity._seeds import Seeds
from fricmb.values import value_of

#: Part by which a number is changed to find the slope of what is linear in it; a power of 2.
_LITTLE = 2.0**-7


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


class Vibrates:
    """Stiffness and damping of a modal body, or of matrices, on rows of q and v."""

    seeded = False

    def __init__(self, rows: list[int], K: Any, C: Any) -> None:
        self.rows, self.matrices = np.array(rows, dtype=np.int64), (_dense(K), _dense(C))

    def add(self, moment: Moment, found: Found) -> None:
        """Their forces."""
        for matrix, values, first in ((self.matrices[0], moment.q, 0), (self.matrices[1], moment.v, moment.frame.n)):
            if matrix is not None:
                found.force[self.rows] -= matrix @ values[self.rows]
                for a, b in zip(*np.nonzero(matrix), strict=True):
                    found.add_slope(int(self.rows[a]), first + int(self.rows[b]), -matrix[a, b])

    def is_linear(self, moment: Moment) -> bool:
        """It is."""
        return True


def _dense(matrix: Any) -> Floats | None:
    if matrix is None:
        return None
    found: Floats = np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float)
    return np.diag(found) if found.ndim == 1 else found


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
) -> tuple[Floats, list[tuple[int, int, float]], Floats]:
    """The mass matrix (n, n), (row, column, slope) of masses that depend on a parameter, and what changes count by.

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
                    seeded += [(i, j, slope) for j, slope in mass.slopes.items()]
        elif isinstance(part, ModalBody | SpaceBody):
            values = part.masses() if isinstance(part, SpaceBody) else modal_matrices(part)[0].tolist()
            for name, value in zip(part.dof_names, values, strict=True):
                if name in index:
                    M[index[name], index[name]] += value
            seeded += _seeded_masses(scene, part, index, seeds) if isinstance(part, SpaceBody) else []
            least = part.least_masses() if isinstance(part, SpaceBody) else values
            weights[[index[name] for name in part.dof_names if name in index]] = [
                value for name, value in zip(part.dof_names, least, strict=True) if name in index
            ]
        elif isinstance(part, MatrixElement) and part.M is not None and part.name in parts:
            at = np.array([index[name] for name in part.dofs])
            M[np.ix_(at, at)] += _dense(value_of(part.M))
    lacking = np.maximum(weights - np.diag(M), 0.0)
    return M, seeded, M + np.diag(lacking)


def _seeded_masses(
    scene: Any, body: SpaceBody, index: dict[str, int], seeds: Seeds
) -> list[tuple[int, int, float]]:
    """Slopes of the masses of a body in space, which are linear in its mass and inertias."""
    found = []
    for name in dict.fromkeys(seeds.touch(body)):
        value = float(value_of(scene.parameters[name]))
        other = scene.with_parameters({name: value * (1.0 + _LITTLE)})[body.name]
        for dof, m, n in zip(body.dof_names, body.masses(), other.masses(), strict=True):
            if dof in index and m != n:
                found.append((index[dof], seeds.columns[name], (n - m) / (_LITTLE * value)))
    return found


def _masses(part: Body | RigidBody, seeds: Seeds) -> list[tuple[str, Dual]]:
    """What each degree of freedom of a body has to move."""
    mass = seeds.dual(part.mass, f"{part.name}.mass")
    if isinstance(part, Body):
        return [(name, mass) for name in part.dof_names]
    inertia = seeds.dual(part.inertia, f"{part.name}.inertia")
    return list(zip(part.dof_names, (mass, mass, inertia), strict=True))


def acting(scene: Any, part: Any, index: dict[str, int], seeds: Seeds) -> Acting | None:
    """A part other than a contact as forces; None for one that only carries masses or a motion."""
    if isinstance(part, Force):
        return Pushes(part, seeds)
    if isinstance(part, Gravity):
        return Falls(scene, part, index, seeds)
    if isinstance(part, ModalBody):
        _refuse_matrices(part, seeds)
        built = [i for i, name in enumerate(part.dof_names) if name in index]
        _, stiffness, damping = modal_matrices(part)
        rows = [index[part.dof_names[i]] for i in built]
        return Vibrates(rows, stiffness[built], damping[np.ix_(built, built)] if damping.ndim == 2 else damping[built])
    if isinstance(part, MatrixElement):
        _refuse_matrices(part, seeds)
        K, C = (None if m is None else value_of(m) for m in (part.K, part.C))
        return None if K is None and C is None else Vibrates([index[name] for name in part.dofs], K, C)
    return Acts(part, seeds) if hasattr(part, "local_coordinates") else None


def _refuse_matrices(part: Any, seeds: Seeds) -> None:
    held = [name for name in seeds.touch(part) if ".position." not in name and ".velocity." not in name]
    if held:
        refuse(part, f"the parameter {held[0]!r} of a part that is given by modes or matrices")


def refuse(part: Any, what: str) -> NoReturn:
    """Say what is not covered."""
    raise SceneError(f"sensitivities: {type(part).__name__} {part.name!r}: {what} is not covered")
