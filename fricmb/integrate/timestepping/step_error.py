"""The error of a step: what it makes of the end done whole and by halves."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.friction_cone import stick_limit_slope
from fricmb.integrate.problem import EVENT_REVERSAL, EVENT_STICK, STICK
from fricmb.integrate.timestepping.layout import HERE, LIMIT, MIDDLE, POSITION, THERE, VELOCITY, WHOLE
from fricmb.integrate.timestepping.room import Run


@kernel
def set_leeway(run: Run) -> None:
    """How much more than elsewhere the error may be where a transition falls into the step, into ``trial``.

    There it is of second order and comes once; in smooth motion it is of third order and comes every step.
    """
    for i in range(run.trial.shape[0]):
        run.trial[i] = 1.0
    for c in range(run.status.shape[0]):
        if run.what[WHOLE, c] >= 0 or run.what[MIDDLE, c] >= 0 or run.what[THERE, c] >= 0:
            for a in range(run.row[c], run.row[c + 1]):
                for e in range(run.w_start[a], run.w_start[a + 1]):
                    run.trial[run.w_dof[e]] = run.leeway


@kernel
def find_limits(run: Run) -> None:
    """The largest limit of friction in each part, into ``largest``."""
    for k in range(run.largest.shape[0]):
        run.largest[k, LIMIT] = 0.0
    for c in range(run.status.shape[0]):
        run.largest[run.part_of[c], LIMIT] = max(run.largest[run.part_of[c], LIMIT], run.brake[c])


@kernel
def holding_error(run: Run) -> float:
    """Difference of the forces that hold contacts, and of their limits, relative to the largest limit of their part."""
    find_limits(run)
    worst = 0.0
    for c in range(run.status.shape[0]):
        limit = run.largest[run.part_of[c], LIMIT]
        if not limit > 0.0:
            continue
        if run.mode[WHOLE, c] == STICK and run.mode[THERE, c] == STICK and run.mode[HERE, c] == STICK:
            # where it jumped in the step, means over its parts are not the same
            jolted = run.jolted[WHOLE, c] + run.jolted[MIDDLE, c] + run.jolted[THERE, c] > 0
            for a in range(run.row[c], run.row[c] if jolted else run.row[c + 1]):
                worst = max(worst, abs(run.ends[WHOLE, a] - run.ends[THERE, a]) / limit)
            if run.var[c] == 1:
                halves = 0.5 * (run.push[MIDDLE, c] + run.push[THERE, c])
                slope = stick_limit_slope(run, run.laws, c, run.s, halves)
                worst = max(worst, slope * abs(run.push[WHOLE, c] - halves) / limit)
    return worst


#: Transitions in a step up to which it is asked what they are; of more of them single ones do not tell.
FEW = 2
#: Part of a step behind which a contact comes to rest too late in it to know what holds it then.
LATE = 0.75
#: Part of its limit by which what would hold a contact has to differ from it; in half a step it changes by less.
CLOSE = 0.05


@kernel
def count_transitions(run: Run) -> bool:
    """How many contacts of each part have a transition in the step, done whole or by halves; whether any has."""
    for k in range(run.events.shape[0]):
        run.events[k] = 0
    some = False
    for c in range(run.status.shape[0]):
        if run.what[WHOLE, c] >= 0 or run.what[MIDDLE, c] >= 0 or run.what[THERE, c] >= 0:
            run.events[run.part_of[c]] += 1
            some = True
    return some


@kernel
def hardly_decided(run: Run, c: int, t: float, h: float) -> bool:
    """Whether it hangs on the step that a contact whose slip ends along a line rests there, or goes on the other way.

    In the step that is said by the mean of what would hold it from the end of slip on.  Of two means over times of
    different length a line is drawn back to the instant itself; where both times are the same, a mean close to the
    limit does not tell.
    """
    if run.row[c + 1] - run.row[c] != 1:
        return False
    if turns_or_ends(run.what[MIDDLE, c]) and turns_or_ends(run.what[WHOLE, c]):
        longer, shorter = t + h - run.moment[WHOLE, c], t + 0.5 * h - run.moment[MIDDLE, c]
        if not longer > shorter:
            return False
        mean = run.strain[MIDDLE, c]
        there = mean - (run.strain[WHOLE, c] - mean) * shorter / (longer - shorter)
        return bool((there <= 1.0) != (run.what[MIDDLE, c] == EVENT_STICK))
    return bool(turns_or_ends(run.what[THERE, c]) and abs(run.strain[THERE, c] - 1.0) < CLOSE)


@kernel
def turns_or_ends(what: int) -> bool:
    """Whether a transition is of a contact that has come to rest for an instant."""
    return bool(what in (EVENT_STICK, EVENT_REVERSAL))


@kernel
def doubtful(run: Run, t: float, h: float) -> bool:
    """Whether the few transitions of a part in the step are others by halves than done whole, or too late to tell."""
    if not count_transitions(run):
        return False
    for c in range(run.status.shape[0]):
        whole, first, second = run.what[WHOLE, c], run.what[MIDDLE, c], run.what[THERE, c]
        if (whole < 0 and first < 0 and second < 0) or run.events[run.part_of[c]] > FEW:
            continue
        late = second == EVENT_STICK and run.moment[THERE, c] > t + 0.5 * (1.0 + LATE) * h
        others = (first >= 0 and second >= 0) or max(first, second) != whole
        if late or others or hardly_decided(run, c, t, h):
            return True
    return False


@kernel
def find_largest(run: Run) -> None:
    """Running maxima of every signal, and the largest of each part."""
    for i in range(run.load.shape[0]):
        k = run.part[i]
        run.top_q[i] = max(run.top_q[i], abs(run.q[THERE, i]))
        run.top_v[i] = max(run.top_v[i], abs(run.v[THERE, i]))
        run.largest[k, POSITION] = max(run.largest[k, POSITION], run.top_q[i])
        run.largest[k, VELOCITY] = max(run.largest[k, VELOCITY], run.top_v[i])


@kernel
def step_error(run: Run) -> float:
    """Difference of the whole step and the halves, over three times the tolerance of each signal."""
    find_largest(run)
    set_leeway(run)
    worst = 0.0
    for i in range(run.load.shape[0]):
        most_q, most_v = run.largest[run.part[i], POSITION], run.largest[run.part[i], VELOCITY]
        if most_q > 0.0:
            scale = (run.top_q[i] + 0.01 * most_q + run.floor_q[i]) * run.trial[i]
            worst = max(worst, abs(run.q[WHOLE, i] - run.q[THERE, i]) / scale)
        if most_v > 0.0:
            scale = (run.top_v[i] + 0.01 * most_v + run.floor_v[i]) * run.trial[i]
            worst = max(worst, abs(run.v[WHOLE, i] - run.v[THERE, i]) / scale)
    worst = max(worst, holding_error(run) / run.leeway)
    return float(worst / (3.0 * run.tol))
