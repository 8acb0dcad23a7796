"""Runs that follow each other, seen as one: rows, dense output, energies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any, Generic, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import FricmbError, SceneError, shown
from fricmb.integrate import MotionSamples, Samples, Start, Trajectory
from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.run.chunked_run import concatenate, take
from fricmb.solution._energy import Reference
from fricmb.solution._leaps import Leaps

Flags = NDArray[np.bool_]
_Samples = TypeVar("_Samples", bound=MotionSamples)
_Known = TypeVar("_Known", bound=MotionSamples, covariant=True)
#: A time this far outside a run, relative to the run's times, is its end: accumulated steps of a t_eval.
ROUND_OFF = 1e-10


class Mechanics(Protocol):
    """What a solution asks of the scene it came from; n_t times are the last axis."""

    def attach(self, trajectory: Trajectory) -> None:
        """Give an unpickled trajectory its problem again."""

    def smooth(self) -> Flags:
        """Whether each contact has a force law that never sticks (n_c,)."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints of a mechanism, as events count them; those of two ends of one part are the same."""

    def fastest(self) -> float:
        """Largest angular frequency of what was run."""

    def kinetic(self, samples: MotionSamples, moving: Ints | None = None) -> Floats:
        """Kinetic energy (n_t,); ``moving``: degrees of freedom that do not rest throughout, if known."""

    def potential(self, samples: MotionSamples, moving: Ints | None = None) -> Floats:
        """Stored energy (n_t,)."""

    def delivered(self, samples: MotionSamples) -> Floats | None:
        """Work (n_t,) of loads that have a potential, but for a constant; None where there are none."""

    def rubbed(self, samples: MotionSamples) -> Floats | None:
        """Loss (n_c, n_t) of contacts by the centres of their cones, but for a constant; None where these are at 0."""

    def leaps(self, t_start: float, t_end: float) -> Floats | None:
        """Times between two others at which driven positions jump, rising; None where none can."""

    def signals(self, t: Floats) -> tuple[Floats, Floats]:
        """Positions and velocities of the driven bodies (n_u, n_t)."""

    def freedom(self, samples: MotionSamples) -> int | None:
        """Degrees of freedom of a mechanism, constraints taken off; None for a scene without joints."""

    def reaction(self, joint: str, samples: MotionSamples) -> Floats:
        """Reactions of a joint (rows, n_t)."""


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where a run came from: ``build(scene, **options)`` makes its mechanics again, in any process.

    ``build`` is a function of a module, so that an origin pickles.
    """

    scene: Any
    build: Callable[..., Mechanics]
    options: dict[str, Any] = field(default_factory=dict)


class Piece:
    """One run of an integrator with its origin; pickles, and makes its problem again when it is needed.

    ``t_end``: where to cut the run, if not at its end.
    """

    def __init__(
        self, trajectory: Trajectory, origin: Origin, mechanics: Mechanics | None = None, t_end: float | None = None
    ) -> None:
        self._trajectory = trajectory
        self.origin = origin
        self._mechanics = mechanics
        self._source = ""
        self.t_start, last = trajectory.ends
        self.t_end = last if t_end is None else t_end

    @classmethod
    def again(cls, trajectory: Trajectory, origin: Origin, t_start: float, t_end: float, source: str) -> Piece:
        """A piece out of a file, whose trajectory has no problem yet; tried out when that is first needed."""
        piece = cls.__new__(cls)
        piece._trajectory, piece.origin, piece._mechanics = trajectory, origin, None
        piece.t_start, piece.t_end, piece._source = t_start, t_end, source
        return piece

    @property
    def mechanics(self) -> Mechanics:
        """The scene as mechanics, built at first use in a process."""
        if self._mechanics is None and self._source:
            self._mechanics = self._tried_out()
        elif self._mechanics is None:
            self._mechanics = self.origin.build(self.origin.scene, **self.origin.options)
            self._mechanics.attach(self._trajectory)
        return self._mechanics

    def _tried_out(self) -> Mechanics:
        """Build, attach what a file holds and look at its ends: FricmbError where they do not fit one another."""
        try:
            mechanics = self.origin.build(self.origin.scene, **self.origin.options)
            mechanics.attach(self._trajectory)
            ends = self._trajectory.motion(np.array([self.t_start, self.t_end]))
            first, last = self._trajectory.ends
            if not (is_finite(ends) and first <= self.t_start <= self.t_end <= last):
                raise ValueError("its ends are not those of a run")
        except Exception as error:  # arrays that do not fit one another fail anywhere
            raise FricmbError(f"{self._source}, entry 'run' does not fit its scene: {error}") from error
        return mechanics

    @property
    def trajectory(self) -> Trajectory:
        """The integrator's result, with its problem."""
        if self._mechanics is None:
            _ = self.mechanics
        return self._trajectory

    @property
    def is_whole(self) -> bool:
        """Whether the piece reaches to the end of its trajectory."""
        return self.t_end >= self.trajectory.ends[1]

    @cached_property
    def leaps(self) -> Leaps:
        """Where driven positions jump."""
        return Leaps.of(self.trajectory, self.mechanics)

    def rows(self) -> Samples:
        """Values at the accepted steps."""
        return self._with_input(self._cut(self.trajectory.rows(), self.trajectory.sample, Samples))

    def sample(self, t: Floats) -> Samples:
        """Values at times within the run, in any order."""
        return self._with_input(self.trajectory.sample(t))

    def motion(self, t: Floats) -> MotionSamples:
        """The same without energies, where these cost something."""
        return self._with_input(self.trajectory.motion(t))

    def _with_input(self, samples: _Samples) -> _Samples:
        """With what an integrator does not know of: work of its steady forces that loads do, and what jumps bring."""
        if not isinstance(samples, Samples):
            return samples
        found: Samples = self.leaps.added(samples) if self.leaps.t.size else samples
        given = self._delivered(found)
        if given is not None:
            found = replace(found, input=found.input + given - self._delivered_before)
        rubbed = self._rubbed(found)
        if rubbed is not None:
            found = replace(found, friction_loss=found.friction_loss + rubbed - self._rubbed_before)
        return cast("_Samples", found)

    def _delivered(self, samples: MotionSamples) -> Floats | None:
        return self.mechanics.delivered(samples if self.leaps.span is None else self.leaps.seen(samples))

    def _rubbed(self, samples: MotionSamples) -> Floats | None:
        return self.mechanics.rubbed(samples if self.leaps.span is None else self.leaps.seen(samples))

    @cached_property
    def _rubbed_before(self) -> Floats:
        found = self._rubbed(self.trajectory.motion(np.array([self.t_start])))
        assert found is not None
        return found

    @cached_property
    def _delivered_before(self) -> float:
        given = self._delivered(self.trajectory.motion(np.array([self.t_start])))
        return 0.0 if given is None else float(given[0])

    def energies(self, samples: MotionSamples, moving: Ints | None = None) -> tuple[Floats, Floats]:
        """Kinetic and potential energy (n_t,); ``moving``: degrees of freedom that may move (None: all)."""
        seen = samples if self.leaps.span is None else self.leaps.seen(samples)
        return self.mechanics.kinetic(samples, moving), self.mechanics.potential(seen, moving)

    def row_motion(self) -> MotionSamples:
        """The same without energies, where these cost something."""
        return self._with_input(self._cut(self.trajectory.row_motion(), self.trajectory.motion, MotionSamples))

    def _cut(self, rows: _Samples, sampled: Callable[[Floats], _Samples], kind: type[_Samples]) -> _Samples:
        """Rows up to ``t_end``, which is one of them: a cut within a step is the end of the run all the same."""
        if self.is_whole:
            return rows
        kept = take(rows, slice(0, int(np.searchsorted(rows.t, self.t_end, side="right"))))
        if kept.t.size == 0 or kept.t[-1] >= self.t_end:
            return kept
        return concatenate([kept, sampled(np.array([self.t_end]))], kind)

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in vars(self).items() if name != "leaps"}
        return {**kept, "_mechanics": None}  # a trajectory pickles without its problem


@dataclass(frozen=True, kw_only=True)
class Record(Generic[_Known]):
    """Samples, and for each time the number of the piece it is from (None: there is one piece).

    ``moving``: degrees of freedom that move; None: all may.
    """

    samples: _Known
    piece: Ints | None = None
    moving: Ints | None = None


class Run:
    """One or several pieces end to end.

    Cumulated energies go on from piece to piece.  What the total energy jumps by from one piece to the next (a spring
    that was given another stiffness in between) counts as input.
    """

    def __init__(self, pieces: tuple[Piece, ...]) -> None:
        self.pieces = pieces
        #: What energies are measured against, once somebody has asked.
        self.reference: Reference | None = None

    @property
    def t_start(self) -> float:
        """Start of the first piece."""
        return self.pieces[0].t_start

    @property
    def t_end(self) -> float:
        """End of the last piece."""
        return self.pieces[-1].t_end

    @property
    def scene(self) -> Any:
        """The scene of the last piece."""
        return self.pieces[-1].origin.scene

    @property
    def end(self) -> Start:
        """From where a further run goes on."""
        last = self.pieces[-1]
        if last.is_whole:
            return last.trajectory.end
        samples = last.trajectory.motion(np.array([last.t_end]))
        return Start(t=last.t_end, q=samples.q[:, 0], v=samples.v[:, 0], z=samples.z[:, 0])

    def inside(self, t: Any) -> Floats:
        """Times of the user as an array within the run; SceneError for a time outside by more than round-off."""
        return times_inside(t, self.t_start, self.t_end)

    def rows(self) -> Record[Samples]:
        """Accepted steps of all pieces; the time where two meet is there twice, like a transition."""
        if len(self.pieces) == 1:
            return Record(samples=self.pieces[0].rows(), moving=self.pieces[0].trajectory.moving)
        return _in_line([self._add(k, piece.rows()) for k, piece in enumerate(self.pieces)], Samples)

    def row_motion(self) -> Record[MotionSamples]:
        """The same without energies, where these cost something."""
        if len(self.pieces) == 1:
            return Record(samples=self.pieces[0].row_motion(), moving=self.pieces[0].trajectory.moving)
        return _in_line([piece.row_motion() for piece in self.pieces], MotionSamples)

    def sample(self, t: Floats) -> Record[Samples]:
        """Values at times within the run, in any order; right-hand values where two pieces meet."""
        if len(self.pieces) == 1:
            piece = self.pieces[0]
            return Record(samples=piece.sample(t), moving=piece.trajectory.moving)
        return self._by_piece(t, lambda k, t: self._add(k, self.pieces[k].sample(t)), Samples)

    def motion(self, t: Floats) -> Record[MotionSamples]:
        """The same without energies, where these cost something."""
        if len(self.pieces) == 1:
            piece = self.pieces[0]
            return Record(samples=piece.motion(t), moving=piece.trajectory.moving)
        return self._by_piece(t, lambda k, t: self.pieces[k].motion(t), MotionSamples)

    def _by_piece(
        self, t: Floats, sampled: Callable[[int, Floats], _Samples], kind: type[_Samples]
    ) -> Record[_Samples]:
        """What ``sampled`` says of the times of each piece, in the order of the times."""
        piece = np.searchsorted([p.t_start for p in self.pieces[1:]], t, side="right").astype(np.int64)
        order = np.argsort(piece, kind="stable")
        parts = [sampled(int(k), t[piece == k]) for k in np.unique(piece)]
        back = np.empty_like(order)
        back[order] = np.arange(order.size)
        return Record(samples=take(concatenate(parts, kind), back), piece=piece)

    def energies(self, record: Record[MotionSamples]) -> tuple[Floats, Floats]:
        """Kinetic and potential energy (n_t,)."""
        samples, piece = record.samples, record.piece
        if piece is None:
            return self.pieces[0].energies(samples, record.moving)
        kinetic, potential = np.empty(samples.t.size), np.empty(samples.t.size)
        for k in np.unique(piece):
            mine = piece == k
            kinetic[mine], potential[mine] = self.pieces[k].energies(take(samples, mine))
        return kinetic, potential

    def reaction(self, joint: str, record: Record[MotionSamples]) -> Floats:
        """Reactions of a joint (rows, n_t)."""
        samples, piece = record.samples, record.piece
        if piece is None:
            return self.pieces[0].mechanics.reaction(joint, samples)
        parts = {k: self.pieces[k].mechanics.reaction(joint, take(samples, piece == k)) for k in np.unique(piece)}
        found = np.empty((next(iter(parts.values())).shape[0], samples.t.size))
        for k, values in parts.items():
            found[:, piece == k] = values
        return found

    def signal(self, index: int, t: Floats) -> tuple[Floats, Floats]:
        """Position and velocity (n_t,) of one driven motion."""
        position, velocity = np.empty(t.size), np.empty(t.size)
        piece = np.searchsorted([p.t_start for p in self.pieces[1:]], t, side="right")
        for k in np.unique(piece):
            u, u_dot = self.pieces[k].mechanics.signals(t[piece == k])
            position[piece == k], velocity[piece == k] = u[index], u_dot[index]
        return position, velocity

    def _add(self, k: int, samples: Samples) -> Samples:
        friction, damping, brought = self._before[k]
        return replace(
            samples,
            friction_loss=samples.friction_loss + friction[:, None],
            damping_loss=samples.damping_loss + damping,
            input=samples.input + brought,
        )

    @cached_property
    def _before(self) -> list[tuple[Floats, float, float]]:
        """What was lost and brought in before each piece."""
        friction: Floats = np.zeros(1)
        damping = brought = energy = 0.0
        before = []
        for k, piece in enumerate(self.pieces):
            ends = piece.sample(np.array([piece.t_start, piece.t_end]))
            total = np.add(*piece.energies(ends))
            if k:
                brought += float(total[0] - energy)
            before.append((np.broadcast_to(friction, ends.friction_loss.shape[:1]).astype(float), damping, brought))
            friction = friction + ends.friction_loss[:, 1]
            damping += float(ends.damping_loss[1])
            brought += float(ends.input[1])
            energy = float(total[1])
        return before

    def __getstate__(self) -> dict[str, Any]:
        return {"pieces": self.pieces, "reference": self.reference}


def _in_line(parts: list[_Samples], kind: type[_Samples]) -> Record[_Samples]:
    """Rows of pieces one after the other."""
    numbers = np.repeat(np.arange(len(parts)), [part.t.size for part in parts])
    return Record(samples=concatenate(parts, kind), piece=numbers)


def times_inside(t: Any, t_start: float, t_end: float, name: str = "t") -> Floats:
    """Times as a float array (n_t,), those outside by round-off moved to the end; else a SceneError."""
    try:
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        raise SceneError(f"{name}: got {shown(t)}; expected a time or an array of times") from None
    if times.ndim != 1:
        raise SceneError(f"{name}: got an array of shape {times.shape}; expected one dimension")
    if times.size == 0:
        return times
    low, high = float(times.min()), float(times.max())
    if t_start <= low and high <= t_end:
        return times
    margin = ROUND_OFF * max(abs(t_start), abs(t_end))
    if not (t_start - margin <= low and high <= t_end + margin):
        bad = low if low < t_start - margin else high
        span = f"from {float(t_start)!r} to {float(t_end)!r}"
        raise SceneError(f"{name}: the time {bad!r} is outside the run, which goes {span}")
    return times.clip(t_start, t_end)


def is_finite(samples: MotionSamples, moving: Ints | None = None) -> bool:
    """Whether every number is finite; of degrees of freedom those that move (None: all)."""
    return all(bool(np.isfinite(x).all()) for x in samples.numbers(moving))


def first_bad(samples: MotionSamples) -> int:
    """Number of the first time at which a value is not finite; the number of times if all are."""
    bad = np.zeros(samples.t.size, dtype=bool)
    for f in fields(samples):
        if f.name != "mode":
            bad |= ~np.isfinite(getattr(samples, f.name)).reshape(-1, samples.t.size).all(axis=0)
    return int(np.argmax(bad)) if bad.any() else samples.t.size
