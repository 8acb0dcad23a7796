"""Whether a friction law keeps what integrators rely on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmb._calls import answers
from fricmb.analysis import compiled_force, cycle, settling_distance
from fricmb.errors import shown
from fricmb.laws import FrictionLaw
from fricmb.testing._base import ConformanceError, Floats, Rule, findings, pickles
from fricmb.testing._refusal import refuses
from fricmb.testing._trial import AT_REST, SPEEDS, random_state, velocities
from fricmb.values import value_of

__all__ = ["ConformanceError", "check_law"]


@answers
def check_law(law: FrictionLaw, *, normal_force: float = 3.0) -> None:
    """Try the rules that a run relies on.

    Parameters
    ----------
    law : FrictionLaw
        With the values that it will be used with: a law may keep the rules for some values alone.
    normal_force : float

    Raises
    ------
    ConformanceError
        Naming each broken rule with the numbers that show it.

    Notes
    -----
    Of every law: it pickles; wrong parameters are refused by name; its force is finite from v = 0 to 1e300, odd about
    its offset, turns with the velocity if the law is isotropic; the compiled Jacobian of a force is that of its values.
    Of a coefficient: finite, not negative up to a slip speed of 7, its derivative the slope of its values, its limit at
    r = 0 the declared one.  Of a law without states: the force opposes the slip and is 0 at rest.  Of states:
    finite rates, 0 at rest unless the law ages (``rests``), and no work gained over a closed cycle.
    """
    if not isinstance(law, FrictionLaw):
        raise ConformanceError(f"check_law: must get a friction law, got {shown(law)}")
    rules: tuple[Rule, ...] = (pickles, refuses, _finite_force, _odd, _turns, _jacobian)
    if law.has_coefficient:
        rules += (_coefficient, _derivative, _limit)
    rules += STATE_RULES if law.states else (_opposes, _rests)
    findings(type(law).__name__, rules, law, normal_force)


def _coefficient(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    values = np.asarray(law.coefficient(SPEEDS, normal_force))
    for speed, mu in zip(SPEEDS, values, strict=True):
        if not np.isfinite(mu):
            yield f"coefficient({speed:g}) is {mu}"
        elif mu < 0 and speed <= 7.0:
            yield f"coefficient({speed:g}) is negative: {mu:g}"


def _derivative(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    for speed in SPEEDS[(SPEEDS > 1e-4) & (SPEEDS < 1e4)]:
        h = 1e-5 * speed
        low, mu, high = law.coefficient(np.array([speed - h, speed, speed + h]), normal_force)
        slopes = (high - mu) / h, (mu - low) / h
        given = law.derivative(speed, normal_force)
        # between the slopes on both sides, where the curve may have a corner
        allowed = 1e-4 * max(map(abs, slopes)) + 1e-6 * max(abs(high), 1.0) / speed
        if not min(slopes) - allowed <= given <= max(slopes) + allowed:
            yield f"derivative({speed:g}) is {given:g}, the slope of the coefficient there {0.5 * sum(slopes):g}"


def _limit(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    if law.kind == "smooth":
        return
    declared, found = law.slip_limit(normal_force), float(law.coefficient(1e-12, normal_force))
    if not abs(declared - found) <= 1e-3 * max(abs(declared), 1e-6):
        yield f"slip_limit is {declared:g}, the coefficient at r = 1e-12 is {found:g}"
    if law.break_away(normal_force) < declared * (1.0 - 1e-12):
        yield f"break-away {law.break_away(normal_force):g} is below the limit of slip {declared:g}"


def _finite_force(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    for d in law.dimensions:
        for v in [np.zeros(d), *velocities(d)]:
            force = np.asarray(law.force(v, normal_force, random_state(law, d)))
            if force.shape != v.shape:
                yield f"force at v = {v.tolist()} has the shape {force.shape}"
            elif not np.isfinite(force).all():
                yield f"force at v = {v.tolist()} is {force.tolist()}"


def _opposes(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    for d in law.dimensions:
        for v in velocities(d):
            unit = v / np.abs(v).max()
            power = float(np.asarray(law.force(v, normal_force)) @ unit)
            if power > 0 and np.abs(v).max() <= 7.0:
                yield f"force at v = {v.tolist()} drives the slip"


def _rests(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    for d in law.dimensions:
        force = np.asarray(law.force(np.zeros(d), normal_force))
        if (np.abs(force) > AT_REST).any():
            yield f"force at rest is {force.tolist()}, not 0"


def _close(a: Floats, b: Floats) -> bool:
    return bool(np.allclose(a, b, rtol=1e-9, atol=1e-9 * max(np.abs(a).max(initial=0.0), 1e-200)))


def _odd(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    for d in law.dimensions:
        state = random_state(law, d)
        sign = law_signs(law, d)
        for v in velocities(d, 1e-4, 1e4):
            force, other = law.force(v, normal_force, state), law.force(-v, normal_force, sign * state)
            shift = 2.0 * normal_force * np.array([value_of(c) for c in law.offsets()] or np.zeros(d), dtype=float)
            if not _close(np.asarray(force), -np.asarray(other) - shift):
                yield f"force at v = {v.tolist()} is {force}, at -v it is {other}"


def law_signs(law: FrictionLaw, d: int) -> Floats:
    """-1 for states that turn round with the velocity, 1 for scalars."""
    labels = law.state_labels("xyz"[:d])
    return np.array([1.0 if label in law.scalars else -1.0 for label in labels])


def _turns(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    if not law.isotropic:
        return
    c, s = np.cos(0.7), np.sin(0.7)
    for d in law.dimensions:
        if d == 1:
            continue
        turn = np.eye(d)
        turn[:2, :2] = [[c, -s], [s, c]]
        state = random_state(law, d)
        turned = state.copy()
        vectors = [i for i, sign in enumerate(law_signs(law, d)) if sign < 0]
        for first in vectors[::d]:
            turned[first : first + d] = turn @ state[first : first + d]
        for v in velocities(d, 1e-4, 1e4):
            force, other = law.force(v, normal_force, state), law.force(turn @ v, normal_force, turned)
            if not _close(turn @ force, np.asarray(other)):
                yield f"turning v = {v.tolist()} does not turn the force {force}"


def _jacobian(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    """The compiled Jacobian of a force against differences, from small to large speeds."""
    if law.kind != "smooth":
        return
    rng = np.random.default_rng(0)
    for d in law.dimensions:
        evaluate, n_z = compiled_force(law, d)
        for speed in 10.0 ** rng.uniform(-4, 1, 12):
            state = random_state(law, d) * rng.normal(size=n_z)
            x = np.concatenate([rng.normal(size=d) * speed, [normal_force], state])
            values, jacobian = evaluate(x)
            if not (np.isfinite(values).all() and np.isfinite(jacobian).all()):
                yield f"the compiled force at x = [v, N, z] = {x.tolist()} is not finite"
                continue
            for a in range(len(x)):
                h = 1e-6 * max(abs(x[a]), 1e-9)
                step = np.eye(len(x))[a] * h
                high, low = evaluate(x + step)[0], evaluate(x - step)[0]
                slopes = (high - values) / h, (values - low) / h
                noise = 1e-9 * np.abs(jacobian).max(axis=1) + 4e-15 * np.abs(values) / h
                allowed = 1e-3 * np.maximum(*np.abs(slopes)) + noise
                given = jacobian[:, a]
                if ((given < np.minimum(*slopes) - allowed) | (given > np.maximum(*slopes) + allowed)).any():
                    yield f"the Jacobian at x = [v, N, z] = {x.tolist()} is wrong in column {a}: {given.tolist()}"
                    return


def _rates(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    for d in law.dimensions:
        state = random_state(law, d)
        for v in [np.zeros(d), *velocities(d)]:
            rate = np.asarray(law.rate(v, normal_force, state))
            if not np.isfinite(rate).all():
                yield f"rate at v = {v.tolist()} is {rate.tolist()}"
        rest = np.asarray(law.rate(np.zeros(d), normal_force, state))
        if law.rests and (np.abs(rest) > AT_REST).any():
            yield f"states move at rest: rate {rest.tolist()}"


#: Amplitudes of the cycles, as shares and multiples of the distance over which states settle.
_AMPLITUDES = (0.3, 3.0, 30.0)


def _cycles(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    """Work over a closed cycle, when states have come to repeat: friction takes it, or at least gives none."""
    length = settling_distance(law, normal_force)
    for share in _AMPLITUDES:
        loop = cycle(law, amplitude=share * length, period=2e3 * np.pi * share * length, normal_force=normal_force)
        if not np.isfinite(loop.force).all():
            yield f"force over a cycle of amplitude {share * length:g} is not finite"
        elif loop.work > 1e-6 * loop.amplitude * np.abs(loop.force).max():
            yield f"a cycle of amplitude {share * length:g} gains the work {loop.work:g}"


STATE_RULES: tuple[Rule, ...] = (_rates, _cycles)
