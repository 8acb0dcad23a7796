"""Named motions at many times with their slopes: degrees of freedom, points of modal bodies, prescribed motions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fricmb import stated
from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene import Driven, LinearForm, Scene
from fricmb.sensitivity._dual import Dual, composed, summed
from fricmb.sensitivity._functions import Function, unseen
from fricmb.sensitivity._seeds import Seeds
from fricmb.values import is_expression, value_of

#: How far beside a breakpoint a function of time is evaluated, relative to 1 or the time.
_BESIDE = 1e-13
#: Coefficients of a motion's rate on the rates of the degrees of freedom; of points of bodies that turn with slopes.
Row = list[tuple[int, Any]]


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A motion, its rate, what its acceleration is without those of degrees of freedom, and its row."""

    position: Dual
    rate: Dual
    drift: Dual
    row: Row


class Given:
    """A number or expression of a declaration, of time, motions and parameters.

    ``name``: of its slot; ``order``: of the derivative by time that is meant.
    """

    def __init__(self, value: Any, name: str, seeds: Seeds, *, order: int = 0) -> None:
        self.coordinates: list[str] = []
        self.speeds: list[str] = []
        self.held: list[Dual] = []
        if not is_expression(value):
            number = seeds.dual(value, name)
            self.number: Dual | None = Dual(value=0.0) if order else number
            return
        read, self.number = stated.reads(value), None
        self.coordinates, self.speeds = list(read.coordinates), list(read.speeds)
        self.held = [
            Dual(value=float(s.value), slopes={seeds.columns[s.name]: 1.0} if s.name in seeds.columns else {})
            for s in read.parameters
        ]
        self.function = Function(stated.expression(value, read.symbols, order))
        self.arguments = [Dual(value=0.0), *[None] * (len(self.coordinates) + len(self.speeds)), *self.held]

    def at(self, moment: Moment) -> Dual:
        """Value with its slopes in a moment."""
        if self.number is not None:
            return self.number
        motions = [moment.motion(name).position for name in self.coordinates]
        motions += [moment.motion(name).rate for name in self.speeds]
        return self.function([moment.time, *motions, *self.held])[0]

    def over(self, time: Dual) -> Dual:
        """The same of an expression of time alone."""
        return self.number if self.number is not None else self.function([time, *self.held])[0]


@dataclass(kw_only=True)
class Frame:
    """What tells a name's motion; ``columns``: their number without time, whose column is the last.

    ``start``: time at which prescribed positions stand where the declaration or an earlier run puts them;
    ``breaks``: times at which functions of time break, and their derivatives by parameter column, set once known.
    """

    scene: Scene
    index: dict[str, int]
    seeds: Seeds
    driven: Any
    n: int
    time_column: int
    start: float
    breaks: list[tuple[float, dict[int, float]]] = field(default_factory=list)
    _prescribed: dict[str, tuple[Given, ...]] = field(default_factory=dict)
    _shapes: dict[str, dict[int, dict[str, float]]] = field(default_factory=dict)

    def prescribed(self, name: str) -> tuple[Given, ...]:
        """Position (an offset, where the velocity is given), velocity, acceleration."""
        found = self._prescribed.get(name)
        if found is None:
            owner, _, letter = name.rpartition(".")
            body = self.scene[owner]
            if not isinstance(body, Driven):
                raise SceneError(f"sensitivities: the motion {name!r} is not covered")
            if letter in body.velocity:
                place, value = f"{owner}.velocity.{letter}", body.velocity[letter]
                offset = Given(body.position.get(letter, 0.0), f"{owner}.position.{letter}", self.seeds)
                rates = [Given(value, place, self.seeds, order=k) for k in range(2)]
                found = (offset, *rates)
            else:
                place, value = f"{owner}.position.{letter}", body.position[letter]
                found = tuple(Given(value, place, self.seeds, order=k) for k in range(3))
            self._prescribed[name] = found
        return found

    def shapes(self, name: str) -> dict[int, dict[str, float]]:
        """Slopes of the terms of the motion of a body of modes' point, by columns of parameters in shapes."""
        if name not in self._shapes:
            owner, _, letter = name.rpartition(".")
            points = [point for point in self.scene.points.values() if point.end_name == owner]
            self._shapes[name] = self._slopes_of(points[0], letter) if points else {}
        return self._shapes[name]

    def _slopes_of(self, point: Any, letter: str) -> dict[int, dict[str, float]]:
        found: dict[int, dict[str, float]] = {}
        for j, ones in self.seeds.varied(point.body).items():
            sums: dict[str, float] = {}
            for weight, body in ones:
                for dof, c in body.modal_form(point.point, letter).terms:
                    sums[dof] = sums.get(dof, 0.0) + weight * c
            slopes = {dof: slope for dof, slope in sums.items() if abs(slope) > 1e-12 and dof in self.index}
            if slopes:
                found[j] = slopes
        return found

    def is_integral(self, name: str) -> bool:
        """Whether a prescribed motion is given by its velocity."""
        owner, _, letter = name.rpartition(".")
        body: Any = self.scene[owner]
        return letter in body.velocity


@dataclass(kw_only=True)
class Moment:
    """A run at times t (n_t,): ``q``, ``v`` (n, n_t), ``z`` (n_z, n_t), and the motions that follow."""

    frame: Frame
    t: Floats
    q: Floats
    v: Floats
    z: Floats
    #: Slip (d, n_t) of contacts by number that is known better than as a difference of velocities.
    slip: Mapping[int, Floats] = field(default_factory=dict)
    _made: dict[str, Motion] = field(default_factory=dict)

    def slipping(self, k: int, g: list[Dual]) -> list[Dual]:
        """Slip of a contact, as it follows from velocities, or as it is known."""
        known = self.slip.get(k)
        return g if known is None else [replace(x, value=own) for x, own in zip(g, known, strict=True)]

    @property
    def time(self) -> Dual:
        """Time itself."""
        return Dual(value=self.t, slopes={self.frame.time_column: 1.0})

    def motion(self, name: str) -> Motion:
        """A motion by name."""
        found = self._made.get(name)
        if found is None:
            found = self._made[name] = self._derived(name)
        return found

    def form(self, form: LinearForm) -> Motion:
        """A linear form in named motions."""
        return self._combined([(c, self.motion(name)) for name, c in form.terms], form.constant)

    def _combined(self, parts: list[tuple[float, Motion]], constant: float) -> Motion:
        row = [(i, c * k) for c, part in parts for i, k in part.row]
        position = composed(
            sum((c * p.position.value for c, p in parts), constant), [(c, p.position) for c, p in parts]
        )
        rate = composed(sum(c * p.rate.value for c, p in parts), [(c, p.rate) for c, p in parts])
        drift = composed(sum(c * p.drift.value for c, p in parts), [(c, p.drift) for c, p in parts])
        return Motion(position=position, rate=rate, drift=drift, row=row)

    def _derived(self, name: str) -> Motion:
        frame = self.frame
        i = frame.index.get(name)
        still = Dual(value=0.0)
        if i is not None:
            position = Dual(value=self.q[i], slopes={i: 1.0})
            rate = Dual(value=self.v[i], slopes={frame.n + i: 1.0})
            return Motion(position=position, rate=rate, drift=still, row=[(i, 1.0)])
        owner, _, letter = name.rpartition(".")
        point = frame.scene.rigid_points.get(owner) if frame.scene.is_mechanism else None
        if point is not None:
            return self._point(point, letter)
        terms = frame.scene.motion(name).terms if frame.scene.has_motion(name) else ()
        if terms and terms != ((name, 1.0),):
            shapes = frame.shapes(name)
            return self._shaped(terms, shapes) if shapes else self.form(LinearForm(terms))
        if name in frame.scene.dof_names:  # what the plan left out rests
            start = frame.scene[owner].start_values("position").get(letter, 0.0)  # type: ignore[attr-defined]
            return Motion(position=Dual(value=float(value_of(start))), rate=still, drift=still, row=[])
        return self._prescribed(name)

    def _shaped(self, terms: tuple[tuple[str, float], ...], shapes: dict[int, dict[str, float]]) -> Motion:
        """A point of a body of modes whose shapes hold parameters: coefficients with slopes by column."""
        still = Dual(value=0.0)
        pairs = []
        for name in dict.fromkeys([*(name for name, _ in terms), *(name for own in shapes.values() for name in own)]):
            slopes = {j: own[name] for j, own in shapes.items() if own.get(name, 0.0)}
            pairs.append((self.motion(name), Dual(value=dict(terms).get(name, 0.0), slopes=slopes)))
        return Motion(
            position=summed(m.position.times(c) for m, c in pairs), rate=summed(m.rate.times(c) for m, c in pairs),
            drift=still, row=[(i, c if c.slopes else float(c.value)) for m, c in pairs for i, _ in m.row],
        )  # fmt: skip

    def _point(self, point: Any, letter: str) -> Motion:
        """A point of a body that turns."""
        n, dofs = self.frame.n, [self.frame.index[name] for name in point.body.dof_names]
        q = [Dual(value=self.q[i], slopes={i: 1.0}) for i in dofs]
        v = [Dual(value=self.v[i], slopes={n + i: 1.0}) for i in dofs]
        held = point.own if point.own is not None else point.body.points[point.point]
        offset = [self.frame.seeds.dual(x, f"{point.end_name}.{k}") for k, x in enumerate(held)]
        values = Function(stated.place_motion(point.body))([*q, *v, *offset])
        count, k = len(dofs), point.letters.index(letter)
        letters = len(point.letters)
        slopes = values[letters + k * count : letters + (k + 1) * count]
        plain = [c if c.slopes or np.ndim(c.value) else float(c.value) for c in slopes]
        row: Row = list(zip(dofs, plain, strict=True))
        rate = summed(x.times(c) for x, c in zip(v, slopes, strict=True))
        return Motion(position=values[k], rate=rate, drift=values[letters * (1 + count) + k], row=row)

    def _prescribed(self, name: str) -> Motion:
        frame = self.frame
        place, rate, drift = frame.prescribed(name)
        velocity = rate.over(self.time)
        if not frame.is_integral(name):
            return Motion(position=place.over(self.time), rate=velocity, drift=drift.over(self.time), row=[])
        offset = place.over(self.time)
        slopes = dict(offset.slopes)
        for j, slope in velocity.slopes.items():
            if j != frame.time_column:
                moved = slope * (self.t - frame.start) if rate.number is not None else self._integral(rate, j)
                slopes[j] = slopes.get(j, 0.0) + moved
        if rate.number is None:
            for j, moved in self._jumps(rate).items():
                slopes[j] = slopes.get(j, 0.0) + moved
        slopes[frame.time_column] = velocity.value
        value = offset.value + velocity.value * self.t if rate.number is not None else frame.driven(name, self.t)
        return Motion(position=Dual(value=value, slopes=slopes), rate=velocity, drift=drift.over(self.time), row=[])

    def _jumps(self, rate: Given) -> dict[int, Floats]:
        """What moving breakpoints of a given velocity add to slopes of the position: (v- - v+) dt_b after each."""
        found: dict[int, Floats] = {}
        for t, moved in self.frame.breaks:
            beside = t + _BESIDE * max(1.0, abs(t)) * np.array([-1.0, 1.0])
            with unseen():
                before, after = np.broadcast_to(rate.over(Dual(value=beside)).value, 2)
            for j, dt in moved.items():
                found[j] = found.get(j, 0.0) + (before - after) * dt * (self.t >= t)
        return found

    def _integral(self, rate: Given, column: int) -> Floats:
        """The integral of a slope of a given velocity from the start to each time, by Gauss's rule."""
        order = np.argsort(self.t, kind="stable")
        first = self.t[order[0]]
        breaks = [t for t, _ in self.frame.breaks]
        inside = [t for t in breaks if self.frame.start < t < first]
        between = np.sort(np.concatenate([np.linspace(self.frame.start, first, 65)[:-1], inside]))
        ends = np.concatenate([between, self.t[order]])
        x, w = np.polynomial.legendre.leggauss(8)
        half = 0.5 * np.diff(ends)
        nodes = ends[:-1, None] + half[:, None] * (1.0 + x)
        with unseen():
            slope = rate.over(Dual(value=nodes, slopes={})).slopes[column]
        sums = np.cumsum(half * (np.broadcast_to(slope, nodes.shape) @ w))
        found = np.empty_like(self.t)
        found[order] = sums[between.size - 1 :]
        return found
