"""Impacts of a run: what is hit, velocities behind it, what is held from there on, and when bounces have come to rest.

The loop of a run ends with FAIL_HIT where the distance of an open joint has come to 0.  Of joints that are rigid the
impact is computed here, and the loop goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fricmb.integrate.compile.direct import Direct
from fricmb.integrate.implicit.attempt_step import RESTART
from fricmb.integrate.implicit.impacts.impact_alone import hit_alone, room_alone
from fricmb.integrate.implicit.impacts.impact_in_turn import solve_in_turn
from fricmb.integrate.implicit.impacts.impact_law import GAIN, Answer, Hit, solve_by_poisson, solve_impact
from fricmb.integrate.implicit.impacts.impact_log import ImpactLog, Outcome
from fricmb.integrate.implicit.impacts.impact_rest import Bounces, Hop, Leaving
from fricmb.integrate.implicit.impacts.impact_resume import put_state, resume, tell_changes
from fricmb.integrate.implicit.impacts.impact_surfaces import Surfaces
from fricmb.integrate.implicit.impacts.impact_without_collision import solve_without_collision
from fricmb.integrate.implicit.impacts.impulse_matrix import ImpulseMatrix
from fricmb.integrate.implicit.output.failure_text import NEAR
from fricmb.integrate.mechanism import APART
from fricmb.integrate.problem import NORMAL_REACTION, Codes, Floats, Ints, Problem
from fricmb.integrate.run.outcomes import DONE, FAIL_HIT, FAIL_LOST, FAIL_MARGIN, FAIL_MODES, FAIL_STEP, SLICE_OVER

#: Part of the fastest speed by which speeds behind an impact differ if the order of its contacts matters.
DIFFER = 1e-6
#: Impacts at one instant, for each contact, after which the run ends.
PILE = 8

#: Load that is none, beside the largest force.
LIGHT = 1e-10
#: Impacts between two looks at what else ends a run.
MANY = 100

_hit_alone = Direct(hit_alone)
_put_state, _resume, _tell_changes = Direct(put_state), Direct(resume), Direct(tell_changes)


class Impacts:
    """The impacts of one run.

    Attributes
    ----------
    failure : str or None
        Why the run cannot go on.
    log : ImpactLog
    surfaces : Surfaces
    """

    def __init__(self, problem: Problem, mech: Any, workspace: Any, record: Any, part: Codes) -> None:
        self.problem = problem
        self.failure: str | None = None
        self.surfaces = Surfaces(problem, mech, workspace)
        self.joints = self.surfaces.joints
        self.log = ImpactLog(problem, self.joints)
        self._mech, self._workspace, self._record, self._part = mech, workspace, record, part
        self._inverse = ImpulseMatrix(self.surfaces.mechanism)
        self._bounces = Bounces(len(self.joints.port), float(workspace.y.t), float(workspace.control.rtol))
        mu = self._mu(np.arange(len(self.joints.port)))
        self._alone = room_alone(problem, self.surfaces.mechanism, self._bounces, mu)

    def around(self, drive: partial[int]) -> Callable[[], int]:
        """The loop of the run with impacts in it."""
        step, ws, a = Direct(drive.func), self._workspace, self._alone
        known = self._mech, ws.k, ws.w, ws.y, ws.before, ws.control, ws.out, self._record, self._part, a

        def go_on() -> int:
            for _ in range(MANY):
                code = int(step(*drive.args))
                if code == FAIL_STEP:
                    code = self.lift_off(code)
                if self.may_jump(code):
                    code = self.jump(code)
                if code == DONE and ws.y.t < ws.control.span[1]:
                    continue
                if code != FAIL_HIT:
                    return code
                if _hit_alone(*known):
                    self.log.add_alone(float(ws.y.t), a.found)
                    continue
                code = self.go_through()
                if code != DONE:
                    return code
            return SLICE_OVER

        return go_on

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences about impacts for the user."""
        self.log.bear_impulses(self.problem.contact_names[c] for c in np.flatnonzero(self._alone.bears))
        return self.log.notes

    def at_start(self) -> int:
        """Impacts at the first instant: of what touches and approaches."""
        s = self.surfaces
        s.see_signals()
        s.look()
        hit = s.open & s.rigid & (s.gap <= 10.0 * s.noise) & (s.rates(self._workspace.y.v) < -s.still())
        code = self.go_through() if hit.any() else DONE
        self._workspace.y.work[:] = 0.0  # energies count from what is behind it
        return code

    def go_through(self) -> int:
        """The impact at the present state; DONE, or why the run ends."""
        s, y, before = self.surfaces, self._workspace.y, self._workspace.before
        s.look()
        rate = s.rates(y.v)
        touched = s.touched(rate)
        if (touched & ~s.rigid).any() or not touched.any() or self._piles_up(float(y.t), int(touched.sum())):
            return FAIL_HIT
        self._bounces.begin(float(y.t))
        members, falls = np.flatnonzero(touched | s.held), s.pressed()
        opened = self.joints.dropped.copy()
        _put_state(y, before)
        e = self.joints.restitution[members].copy()
        code, outcome = self._apply(members, e, touched, ())
        if outcome is not None and self.may_jump(code):
            self._tell(members, touched, rate, outcome, [None] * len(members))
            return self.jump(code)
        if code != DONE or outcome is None:
            return code
        hops = self._hops(members, touched, rate, outcome.answer, falls)
        ends = _ending(hops)
        others = self._others(members, rate, hops)
        if ends.any() or others:
            members = np.append(members, [j for j in others if j not in members]).astype(np.int64)
            hops += [None] * (len(members) - len(hops))
            hops = [others.get(j, hop) for j, hop in zip(members.tolist(), hops, strict=True)]
            ends = _ending(hops)
            touched[members[ends]] = True
            e = self.joints.restitution[members].copy()
            _put_state(before, y)
            self.joints.dropped[:] = opened
            e[ends] = 0.0
            forced = tuple({*others, *members[ends].tolist()}) if others else ()
            code, outcome = self._apply(members, e, touched, forced)
            if code != DONE or outcome is None:
                return code
        self._tell(members, touched, rate, outcome, hops)
        return DONE

    def _tell(self, members: Ints, touched: Any, rate: Floats, outcome: Outcome, hops: list[Hop | None]) -> None:
        """Keep an impact and what changes with it."""
        s, y = self.surfaces, self._workspace.y
        # what is left in touch by an impact may bear nothing: its round-off is that of the impulse over the run
        span, out = self._workspace.control.span, self._workspace.out
        push = float(np.abs(outcome.answer.impulse).max(initial=0.0)) / float(span[1] - span[0])
        out.top_force = max(float(out.top_force), push)
        _tell_changes(self._mech, y, self._workspace.before, self._record)
        rested = (touched & s.held)[members].tolist()
        self.log.add(float(y.t), members, rested, np.maximum(-rate[members], 0.0) + 0.0, outcome, hops)

    # -- without collision --------------------------------------------------------------------------------------
    def may_jump(self, code: int) -> bool:
        """Whether a run that finds no forces may go on by an impact without collision."""
        if not self.surfaces.mechanism.jumps:
            return False
        # forces grow without bound towards the edge: steps come to nothing just before it
        near = code == FAIL_STEP and float(self._workspace.out.margin.min(initial=1.0)) < NEAR
        return near or code in (FAIL_MARGIN, FAIL_MODES)

    def jump(self, code: int) -> int:
        """An impact without collision of what is held and slips; ``code`` where there is none that stops it."""
        s, y = self.surfaces, self._workspace.y
        s.look()
        members = np.flatnonzero(s.held)
        if not members.size or self._piles_up(float(y.t), int(members.size)):
            return code
        rate, touched = np.zeros(len(self.joints.port)), np.isin(np.arange(len(self.joints.port)), members)
        problem = self._hit(members, self.joints.restitution[members].copy(), ())
        answer = solve_without_collision(problem[0], poisson=s.mechanism.poisson)
        if answer is None:
            return code
        _put_state(y, self._workspace.before)
        code, outcome = self._leave(members, problem, answer, touched, ())
        if code == DONE and outcome is not None:
            self._begin_anew()
            self._tell(members, np.zeros_like(touched), rate, outcome, [None] * len(members))
        return code

    def lift_off(self, code: int) -> int:
        """Let go of what bears nothing where steps come to nothing; ``code`` where that is not so.

        Of contacts whose loads fall to 0 at one instant, such as corners of a box on a table that drops, one lets go
        first; those of the others are round-off then.
        """
        s, y = self.surfaces, self._workspace.y
        s.look()
        load = np.where(s.held, y.lam[s.first], np.inf)
        members = np.flatnonzero(load <= LIGHT * float(self._workspace.out.top_force))
        if not members.size or self._piles_up(float(y.t), int(members.size)):
            return code
        _put_state(y, self._workspace.before)
        for j in members.tolist():
            s.set_open(j, True)
        found = self._resume([])
        if found != DONE or s.falling(members, s.rates(y.v)).size:
            return code
        _tell_changes(self._mech, y, self._workspace.before, self._record)
        self._begin_anew()
        return DONE

    def _begin_anew(self) -> None:
        """Go on behind steps that came to nothing."""
        record, control = self._record, self._workspace.control
        if record.used[0] > 0:
            record.after[record.used[0] - 1] = 1
        control.h = max(float(control.h), RESTART * float(control.longest))

    def _piles_up(self, t: float, count: int) -> bool:
        """Whether there is no end of impacts at one instant."""
        before = self._bounces.at_once(t)
        if before > PILE * (count + 1):
            self.failure = (
                f"impacts pile up at one instant ({before} at t = {t:.10g}): several contacts come to rest by"
                " impacts in turn, and rest is dated for single contacts alone"
            )
        return self.failure is not None

    # -- velocities behind --------------------------------------------------------------------------------------
    def _apply(
        self, members: Ints, e: Floats, touched: Any, forced: tuple[int, ...]
    ) -> tuple[int, Outcome | None]:
        """Velocities, modes and reactions behind the impact with coefficients e of the members; some are held."""
        s = self.surfaces
        problem = self._hit(members, e, forced)
        hit = problem[0]
        law = solve_by_poisson if s.mechanism.poisson else solve_impact
        answer = solve_in_turn(hit, law) if s.mechanism.in_turn else law(hit)
        if not s.mechanism.in_turn and int((touched & s.open).sum()) > 1:
            self._compare(hit, answer, solve_in_turn(hit, law), members)
        if answer is None:
            names = ", ".join(repr(self.joints.names[j]) for j in members)
            self.failure = (
                f"no impulses satisfy the law of impact at t = {float(self._workspace.y.t):.10g} for {names} together"
            )
            return FAIL_HIT, None
        return self._leave(members, problem, answer, touched, forced)

    def _leave(
        self, members: Ints, problem: tuple[Hit, Floats, Floats, Ints], answer: Answer, touched: Any,
        forced: tuple[int, ...],
    ) -> tuple[int, Outcome | None]:  # fmt: skip
        """Velocities, modes and reactions behind impulses that have been found."""
        s, y = self.surfaces, self._workspace.y
        hit, push, reaction, held = problem
        outcome = Outcome(
            answer=answer, tangential=hit.tangential, lost=-0.5 * answer.impulse * (answer.rate + hit.rate)
        )
        if not self._is_sound(outcome, held, reaction):
            return FAIL_LOST, None
        change = push @ answer.impulse
        fed = float(np.sum(change * self._inverse.momentum(y.v + 0.5 * change)))
        y.v[:] += change
        lost = float(outcome.lost.sum())
        y.work[-2] += lost
        y.work[-1] += fed + lost
        leaves = answer.rate[: len(members)] > s.still()[members]
        for j, apart in zip(members.tolist(), leaves.tolist(), strict=True):
            s.set_open(j, apart)
        code = self._resume([j for j in members.tolist() if touched[j] or j in forced])
        return (self._hold_again(members) if code == DONE else code), outcome

    def _compare(self, hit: Hit, together: Answer | None, in_turn: Answer | None, members: Ints) -> None:
        """Note where contacts that were open are hit at one instant, and it matters whether they are so in turn."""
        if together is None or in_turn is None:
            return
        apart = float(np.abs(together.rate - in_turn.rate).max())
        if apart > DIFFER * float(np.abs(hit.rate).max(initial=0.0)):
            self.log.depend_on_order(float(self._workspace.y.t), [self.joints.names[j] for j in members.tolist()])

    def _hit(self, members: Ints, e: Floats, forced: tuple[int, ...]) -> tuple[Hit, Floats, Floats, Ints]:
        """The problem of the impact, velocities and reactions (of rows held both ways) by its unit impulses."""
        s, y, mu = self.surfaces, self._workspace.y, self._mu(members)
        port, row = self.joints.port[members], self.problem.contacts.row
        along = np.flatnonzero((port >= 0) & (mu > 0.0))
        slip = row[port[along]]
        A = np.concatenate([s.G[s.first[members]], s.W[slip]])
        before = A @ y.v + np.concatenate([s.G0[s.first[members]], s.W0[slip]])
        held = self._held_both_ways()
        push, reaction = self._inverse.answers(s.G[held], A)
        tangential = np.full(len(members), -1)
        tangential[along] = len(members) + np.arange(along.size)
        hit = Hit(
            D=A @ push, rate=before, normal=np.arange(len(members)), tangential=tangential, e=e,
            e_t=self.joints.tangential[members], mu=mu, forced=np.isin(members, forced), given=np.zeros(len(members)),
        )  # fmt: skip
        return hit, push, reaction, held

    def _mu(self, members: Ints) -> Floats:
        """Coefficients of friction in impacts."""
        contacts, port, own = self.problem.contacts, self.joints.port[members], self.joints.mu_impact[members]
        if not contacts.mu_0.size:
            return np.zeros(len(members))
        found: Floats = np.where(port < 0, 0.0, np.where(np.isnan(own), contacts.mu_0[np.maximum(port, 0)], own))
        return found

    def _held_both_ways(self) -> Ints:
        """Rows that hold in an impact both ways: of joints that are there and not rigid."""
        owner = self.joints.owners(np.arange(len(self.joints.dropped)))
        found: Ints = np.flatnonzero((self.joints.dropped == 0) & ~self.surfaces.rigid[owner])
        return found

    def _is_sound(self, outcome: Outcome, held: Ints, reaction: Floats) -> bool:
        """Whether no energy is gained, and nothing that only pushes would have to pull; ``failure`` says so if not."""
        y, lost = self._workspace.y, outcome.lost
        scale = 0.5 * float(np.sum(y.v * self._inverse.momentum(y.v))) + float(np.abs(lost).sum())
        if lost.sum() < -GAIN * scale:
            self.failure = (
                f"the impact at t = {float(y.t):.10g} would gain the energy {-lost.sum():.3g}: Newton's law of"
                " impact does with this friction; fm.ImpactLaw with law='poisson' never does, nor does"
                " tangential_restitution equal to restitution"
            )
            return False
        owner = self.joints.owners(held)
        impulse = reaction @ outcome.answer.impulse
        wrong = (self.joints.one_sided[owner] != 0) & (impulse < -1e-9 * np.abs(impulse).max(initial=0.0))
        if wrong.any():
            name = self.joints.names[owner[int(np.argmax(wrong))]]
            self.failure = f"contact of {name!r} is lost in an impact: it would have to pull (surfaces only push)"
            return False
        dry = (self.joints.port[owner] >= 0) & (np.abs(impulse) > 0.0)
        if dry.any():
            ports = self.joints.port[owner[dry]]
            rubs = ports[self.problem.contacts.normal[ports] == NORMAL_REACTION]
            self.log.bear_impulses([self.problem.contact_names[c] for c in rubs.tolist()])
        return True

    def _resume(self, members: list[int]) -> int:
        """Modes and reactions of what is held; ports of ``members`` that are held are so from now on."""
        ws, fresh = self._workspace, np.zeros(self.problem.n_c, np.int8)
        for j in members:
            if not self.surfaces.open[j]:
                fresh[self.surfaces.pressed_ports(j)] = 1
        ws.out.opened = int((self.joints.dropped == APART).sum())
        return int(_resume(self._mech, ws.k, ws.w, ws.y, ws.control, ws.out, self._part, fresh))

    def _hold_again(self, members: Ints) -> int:
        """Hold what rests on its surface and would fall into it, since something else has let go."""
        for _ in range(len(members) + 1):
            falls = self.surfaces.falling(members, self.surfaces.rates(self._workspace.y.v))
            if not falls.size:
                return DONE
            self.surfaces.set_open(int(falls[0]), False)
            code = self._resume([int(falls[0])])
            if code != DONE:
                return code
        return FAIL_MODES

    def _others(self, members: Ints, rate: Floats, hops: list[Hop | None]) -> dict[int, Hop]:
        """Open contacts that come to rest with those hit now, by impacts in turn: all that are near by, or none."""
        s, y = self.surfaces, self._workspace.y
        bounces = {j for j, hop in zip(members.tolist(), hops, strict=True) if hop is not None}
        if any(hop is not None and not hop.ends for hop in hops):
            return {}
        now, pressed, reach, pace = s.rates(y.v), s.pressed(), s.reach(), s.pace()
        fastest = float(np.max(-rate[members], initial=0.0))
        found = {}
        for j in np.flatnonzero(s.open & s.rigid).tolist():
            if j in bounces:
                continue
            leaving = Leaving(
                joint=j, t=float(y.t), speed=float(now[j]), e=float(self.joints.restitution[j]),
                rises=float(pressed[j]), falls=float(pressed[j]), size=float(reach[j]), noise=float(s.noise[j]),
            )  # fmt: skip
            ratio = float(now[j]) / max(fastest, 1e-300)
            hop = self._bounces.among_others(leaving, float(s.gap[j]), ratio, float(pace[j]))
            if hop.ends:
                found[j] = hop
        return found

    def _hops(self, members: Ints, touched: Any, rate: Floats, answer: Answer, falls: Floats) -> list[Hop | None]:
        """The bounce that each member begins, where it does; ``falls``: accelerations before the impact."""
        s, t = self.surfaces, float(self._workspace.y.t)
        rises, reach, hops = s.pressed(), s.reach(), []
        for i, j in enumerate(members.tolist()):
            speed, leaves = float(answer.rate[i]), bool(touched[j] and s.open[j] and answer.impulse[i] > 0.0)
            hops.append(
                self._bounces.after(
                    Leaving(
                        joint=j, t=t, speed=speed, e=float(self.joints.restitution[j]), rises=float(rises[j]),
                        falls=float(falls[j]), size=max(float(reach[j]), -float(rate[j])), noise=float(s.noise[j]),
                    )
                )
                if leaves and speed > 0.0
                else None
            )  # fmt: skip
        return hops


def _ending(hops: list[Hop | None]) -> Any:
    """Whether bounces end with each of these hops."""
    return np.array([hop is not None and hop.ends for hop in hops])
