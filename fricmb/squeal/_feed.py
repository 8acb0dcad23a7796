"""What feeds a growing mode: its growth rate as a sum over contacts and other parts, and over pairs of modes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from fricmb.analysis import SteadySliding
from fricmb.analysis._linearise import contact_slopes, linearise, stiffness_without_friction
from fricmb.analysis._losses import with_ends
from fricmb.scene import Element, MatrixElement, ModalBody, Scene, Spring
from fricmb.squeal._place import Complexes, Floats
from fricmb.system import build

#: Shares smaller than this part of the largest are round-off.
_ROUND_OFF = 1e-9


@dataclass(frozen=True, kw_only=True)
class Pair:
    """Two modes of the structure without friction that feed each other.

    Attributes
    ----------
    modes : (int, int)
        Numbers in rising order of frequency, as in ``scene.modes()``.
    frequencies : (float, float)
        Angular.
    moves : (str, str)
        Degree of freedom that moves most in each.
    share : float
        Of the growth rate.
    """

    modes: tuple[int, int]
    frequencies: tuple[float, float]
    moves: tuple[str, str]
    share: float


@dataclass(frozen=True, kw_only=True)
class Feed:
    """Growth rate of one mode as a sum over the parts of the scene.

    With the shape x and the force ``-D(lambda) x`` of a part, its share is ``-Im(x^H D x)/(2 omega x^H M x)``: the work
    of its force in one cycle over that cycle's kinetic energy, times a constant.  Conservative parts have none.

    Attributes
    ----------
    at : dict of str to float
        Values of the parameters.
    eigenvalue : complex
    parts : dict of str to float
        Share of each contact, damper, modal body and matrix element, in 1/time; above 0 it feeds.
    pairs : tuple of Pair
        Contribution of the non-symmetric part of the stiffness, by pairs of modes of the structure; largest first.
    velocity : float
        Contribution of forces that depend on velocities: damping, falling friction, law states.  With the pairs it adds
        up to the growth rate.
    """

    at: Mapping[str, float]
    eigenvalue: complex
    parts: Mapping[str, float]
    pairs: tuple[Pair, ...]
    velocity: float

    @property
    def growth(self) -> float:
        """The growth rate."""
        return self.eigenvalue.real

    def __str__(self) -> str:
        lines = [f"growth rate {self.growth:.6g} at angular frequency {self.eigenvalue.imag:.8g}, of which"]
        lines += [f"  {share:+12.6g}  {name}" for name, share in self.parts.items()]
        lines.append("by pairs of modes of the structure")
        lines += [
            f"  {p.share:+12.6g}  {p.modes[0]} ({p.frequencies[0]:.6g}, {p.moves[0]}) and"
            f" {p.modes[1]} ({p.frequencies[1]:.6g}, {p.moves[1]})"
            for p in self.pairs[:5]
        ]
        lines.append(f"  {self.velocity:+12.6g}  all that depends on velocities")
        return "\n".join(lines)


def feed(steady: SteadySliding, at: Mapping[str, float], eigenvalue: complex, shape: Complexes) -> Feed:
    """Shares of a mode's growth rate.

    Parameters
    ----------
    steady : SteadySliding
    at : dict of str to float
        What to say about it.
    eigenvalue : complex
        Of an oscillation.
    shape : (n_free,) complex
    """
    system = steady.system
    x = np.zeros(system.problem.n, complex)
    x[steady.free] = shape
    mass = float((x.conj() @ system.problem.linear.M @ x).real)
    unit = 1.0 / (2.0 * eigenvalue.imag * mass)
    found = dict(_contacts(steady, eigenvalue, x)) | dict(_others(steady, eigenvalue, x))
    shares = {name: float((x.conj() @ force).imag) * unit for name, force in found.items()}
    largest = max(map(abs, shares.values()), default=0.0)
    parts = {name: share for name, share in shares.items() if abs(share) > _ROUND_OFF * largest}
    order = sorted(parts, key=lambda name: -parts[name])
    pairs = _pairs(steady, x, eigenvalue.imag, mass)
    return Feed(
        at=dict(at), eigenvalue=eigenvalue, parts={name: parts[name] for name in order}, pairs=tuple(pairs[:20]),
        velocity=eigenvalue.real - sum(pair.share for pair in pairs),
    )  # fmt: skip


def _contacts(steady: SteadySliding, eigenvalue: complex, x: Complexes) -> Iterator[tuple[str, Complexes]]:
    """Force (n,) of each contact in a mode, its states following."""
    system, n = steady.system, x.size
    y = np.concatenate([x, eigenvalue * x])
    slopes = contact_slopes(system, steady.q, steady.v, steady.z)
    for name, slope in zip(system.contact_names, slopes, strict=True):
        force = slope.force_X[:, 1 : 1 + 2 * n] @ y
        if slope.rate.size:
            swing = eigenvalue * np.eye(slope.rate.size) - slope.rate_z
            force = force + slope.force_z @ np.linalg.solve(swing, slope.rate_X[:, 1 : 1 + 2 * n] @ y)
        yield name, force


def _others(steady: SteadySliding, eigenvalue: complex, x: Complexes) -> Iterator[tuple[str, Complexes]]:
    """Force (n,) of each other part that may feed or take."""
    scene, names = steady.scene, list(steady.system.dof_names)
    for part in scene.parts:
        if not isinstance(part, Element | MatrixElement | ModalBody) or isinstance(part, Spring):
            continue
        small = _alone(scene, part)
        system = build(small)
        places = [names.index(name) for name in system.dof_names]
        at = linearise(system, steady.q[places], steady.v[places], np.zeros(0))
        n, local = len(places), x[places]
        force = np.zeros(x.size, complex)
        force[places] = at.force_y[:, : 2 * n] @ np.concatenate([local, eigenvalue * local])
        yield part.name, force


def _alone(scene: Scene, part: Element | MatrixElement | ModalBody) -> Scene:
    """A scene of one part and the bodies it is tied to."""
    if isinstance(part, ModalBody):
        return Scene("alone", [part])
    if isinstance(part, MatrixElement):
        owners = {name.partition(".")[0] for name in part.dofs}
    else:
        owners = {motion.partition(".")[0] for form in part.local_coordinates() for motion in form.motions}
    found: Scene = with_ends(scene, owners, part)
    return found


def _pairs(steady: SteadySliding, x: Complexes, omega: float, mass: float) -> list[Pair]:
    """What the skew part of stiffness brings, by pairs of modes of the structure, largest first."""
    system, free = steady.system, steady.free
    M = system.problem.linear.M[np.ix_(free, free)]
    K = stiffness_without_friction(system, steady.q, steady.v)[np.ix_(free, free)]
    squares, shapes = eigh(K, M)
    whole: Floats = -steady.at.force_y[np.ix_(free, free)]
    skew = shapes.T @ (0.5 * (whole - whole.T)) @ shapes
    eta = shapes.T @ (M @ x[free])
    share = -skew * (eta.conj()[:, None] * eta).imag / (omega * mass)
    i, j = np.triu_indices(len(eta), 1)
    order = np.argsort(-np.abs(share[i, j]))
    names = [system.dof_names[k] for k in free]
    moves = [names[int(np.argmax(np.abs(shapes[:, k])))] for k in range(len(eta))]
    own = np.sqrt(np.maximum(squares, 0.0))
    return [
        Pair(
            modes=(int(a), int(b)), frequencies=(float(own[a]), float(own[b])), moves=(moves[a], moves[b]),
            share=float(share[a, b]),
        )
        for a, b in zip(i[order], j[order], strict=True)
    ]  # fmt: skip
