"""Borders of a branch, where the sequence of transitions changes: solved directly, and how the branch goes on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fricmb.analysis._errors import Floats
from fricmb.analysis.cycles._drive import places_are_integrals
from fricmb.analysis.cycles._field import Field
from fricmb.analysis.cycles._frozen import Condition, Found, Frozen, Phase, newton
from fricmb.analysis.cycles._sequence import Border
from fricmb.analysis.cycles._shooting import Orbit, Shooting
from fricmb.integrate import STICK

#: First step away from a border, in units of the cycle's extent; halved until the orbit is what it should be.
_STEP, _HALVINGS = 0.02, 6
#: The same where the orbit on a border itself cannot be run.
_BEFORE = 1e-4
#: A phase shorter than this part of the period has the length 0.
_INSTANT = 1e-6


@dataclass(frozen=True, kw_only=True)
class Solved:
    """A border that was solved: the orbit on it."""

    border: Border
    frozen: Frozen
    found: Found

    @property
    def value(self) -> float:
        """Parameter."""
        return self.frozen.unpack(self.found.u)[2]


def solve_border(orbit: Orbit, border: Border, over: str, p_scale: float) -> Solved | None:
    """The orbit on a border, from a cycle that is near it; None if it is not found."""
    shooting = orbit.shooting
    frozen = Frozen(
        scene=shooting.flow.scene, over=over, phases=border.phases, start=border.start, drive=shooting.drive,
        y_scale=shooting.scale, T_scale=orbit.T, p_scale=p_scale,
    )  # fmt: skip
    p = float(shooting.flow.scene.parameters[over])
    found = newton(frozen, frozen.pack(border.y, border.lengths, p, border.t))
    if found is None or (frozen.unpack(found.u)[1] < -_INSTANT * orbit.T).any():
        return None
    return Solved(border=border, frozen=frozen, found=found)


def on_border(solved: Solved, shooting: Shooting) -> Orbit:
    """The orbit on a border as a lap from a calm instant.

    One that only just gets to its stick is taken a little before the border: a run along it may miss the stick by
    round-off.
    """
    if solved.border.kind == "arrival":
        return as_lap(*_just_before(solved), shooting, solved.frozen.over)
    return as_lap(solved.frozen, solved.found.u, shooting, solved.frozen.over)


def beyond(solved: Solved, shooting: Shooting) -> tuple[Orbit, Floats] | None:
    """A cycle on the other side, and the direction (period, parameter) in which it lies, scaled.

    None where there is no other side: a slip that touches 0 under mu_s > mu_k would stick for a finite time, and one
    that gets to a stick without deceleration would miss it.
    """
    side = _other_side(solved)
    if side is None:
        return None
    frozen, u, valid = side
    tangent = np.linalg.svd(frozen.jacobian(u))[2][-1]
    h = 1e-5
    if valid(u + h * tangent) < valid(u - h * tangent):
        tangent = -tangent
    step = _STEP
    for _ in range(_HALVINGS):
        found = newton(frozen, u + step * tangent)
        if found is not None and valid(found.u) > 0.0 and (frozen.unpack(found.u)[1] > 0.0).all():
            _, lengths, p, _ = frozen.unpack(found.u - u)
            direction = np.array([lengths.sum() / frozen.T_scale, p / frozen.p_scale])
            return as_lap(frozen, found.u, shooting, frozen.over), direction
        step *= 0.25
    return None


def _just_before(solved: Solved) -> tuple[Frozen, Floats]:
    """An orbit near a border that gets to its stick with a little deceleration; the parameter differs by its square."""
    frozen = replace(solved.frozen, start=solved.frozen.start[:1])
    _, arrival = solved.frozen.start
    tangent = np.linalg.svd(frozen.jacobian(solved.found.u))[2][-1]
    for step in (_BEFORE, -_BEFORE):
        found = newton(frozen, solved.found.u + step * tangent)
        if found is not None and solved.border.before * frozen.missed(arrival, found.u) < 0.0:
            return frozen, found.u
    return solved.frozen, solved.found.u


def as_lap(frozen: Frozen, u: Floats, shooting: Shooting, over: str) -> Orbit:
    """A frozen orbit as a lap from the middle of its longest phase, of those with the fewest stuck contacts."""
    state, lengths, p, t_start = frozen.unpack(u)
    at, T = shooting.with_values({over: p}), float(lengths.sum())
    left = _until_calm(frozen, lengths)
    if at.drive is not None and places_are_integrals(at.system, at.flow.scene):
        left = float(-t_start % T)
    t, y, phase = np.array([t_start]), state[:, None], frozen.phases[0]
    for phase, length in zip(frozen.phases, lengths.tolist(), strict=True):
        y = frozen.advance(at.system, phase, t, y, np.array([min(left, length)]))
        t, left = t + min(left, length), left - length
        if left <= 0.0:
            break
    rate = Field(system=at.system, mode=phase.mode, direction=phase.direction)(t, y)[:, 0]
    share = 0.0 if at.drive is None else (float(t[0]) / T) % 1.0
    at = replace(at, phase=share, section=None, anchor=y[:, 0], normal=rate / at.scale**2)
    return at.orbit(y[:, 0], T, (over,))


def _until_calm(frozen: Frozen, lengths: Floats) -> float:
    """Time from the start to the middle of the longest phase, of those with the fewest stuck contacts."""
    stuck = np.array([int((phase.mode == STICK).sum()) for phase in frozen.phases])
    calm = int(np.argmax(np.where(stuck == stuck[lengths > 0.0].min(), lengths, -1.0)))
    return float(lengths[:calm].sum() + 0.5 * lengths[calm])


def _other_side(solved: Solved) -> tuple[Frozen, Floats, Callable[[Floats], float]] | None:
    """Equations of the orbits beyond a border, its orbit as their unknowns, and what is positive beyond it."""
    border, frozen, k = solved.border, solved.frozen, solved.border.contact
    if border.kind == "arrival":
        return None
    stop = Condition(kind="stop", contact=k)
    if border.kind == "stick":
        frozen, u = _without_instants(frozen, solved.found.u)
        if border.before == border.after:
            other = replace(frozen, start=(Condition(kind="turn", contact=k),))
            return other, u, lambda w: border.before * other.missed(stop, w)
        other = replace(frozen, start=(stop,))
        return other, u, lambda w: other.missed(border.start[1], w)
    if border.kind == "touch" and not _holds_at_once(solved):
        return None
    frozen, u = _with_instants(frozen, solved.found.u)
    y, lengths, p, t = frozen.unpack(u)
    other = replace(frozen, start=(stop,), phases=(_stick(frozen.phases[0], k, border.after), *frozen.phases))
    return other, other.pack(y, np.concatenate([[0.0], lengths]), p, t), lambda w: float(other.unpack(w)[1][0])


def _stick(after: Phase, k: int, direction: float) -> Phase:
    """A stick of contact k before a phase in which it slips in a direction."""
    mode = after.mode.copy()
    mode[k] = STICK
    return Phase(mode=mode, direction=after.direction, end=Condition(kind="release", contact=k, sign=-direction))


def _without_instants(frozen: Frozen, u: Floats) -> tuple[Frozen, Floats]:
    """Without other sticks that have the length 0 on a border as well, as those of a symmetric cycle do.

    Slip turns round there instead: a stick of length 0 between slips of one direction is left where it is.
    """
    y, lengths, p, t = frozen.unpack(u)
    row = frozen.system(p).problem.contacts.row
    kept = []
    for i, phase in enumerate(frozen.phases):
        end, around = phase.end, (frozen.phases[i - 1], frozen.phases[(i + 1) % len(frozen.phases)])
        turns = end is not None and end.kind == "release" and _turns(around, int(row[end.contact]))
        if not (turns and 0 < i < len(frozen.phases) - 1 and abs(lengths[i]) < _INSTANT * frozen.T_scale):
            kept.append(i)
    fewer = replace(frozen, phases=tuple(frozen.phases[i] for i in kept))
    return fewer, fewer.pack(y, lengths[kept], p, t)


def _turns(around: tuple[Phase, Phase], row: int) -> bool:
    return bool(around[0].direction[row] * around[1].direction[row] < 0.0)


def _with_instants(frozen: Frozen, u: Floats) -> tuple[Frozen, Floats]:
    """With sticks of length 0 at all other reversals at which the force can just hold on a border."""
    y, lengths, p, t = frozen.unpack(u)
    system, when, state = frozen.system(p), np.array([t]), y[:, None]
    phases: list[Phase] = []
    spans: list[float] = []
    for i, phase in enumerate(frozen.phases):
        phases.append(phase)
        spans.append(float(lengths[i]))
        state = frozen.advance(system, phase, when, state, lengths[i : i + 1])
        when = when + lengths[i]
        if phase.end is None or phase.end.kind != "stop":
            continue
        following, k = frozen.phases[i + 1], phase.end.contact
        row = int(system.problem.contacts.row[k])
        stick = _stick(following, k, float(following.direction[row]))
        assert stick.end is not None
        if following.mode[k] != STICK and abs(frozen.value(system, stick.end, stick, when, state)[0]) < 1e-6:
            phases.append(stick)
            spans.append(0.0)
    more = replace(frozen, phases=tuple(phases))
    return more, more.pack(y, np.array(spans), p, t)


def _holds_at_once(solved: Solved) -> bool:
    """Whether the force of break-away is that of slip near 0, so that a stick begins with the length 0."""
    release = Condition(kind="release", contact=solved.border.contact, sign=-solved.border.after)
    return abs(solved.frozen.missed(release, solved.found.u)) < 1e-7
