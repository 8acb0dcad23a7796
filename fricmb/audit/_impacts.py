"""Impacts: momentum, the law of impact in every direction, energy; surfaces are not entered and only push."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.audit._gather import LIMIT, Gathered
from fricmb.audit._points import row_unit
from fricmb.audit._units import ROUND_OFF, Units
from fricmb.field._motions import Moment, Row
from fricmb.field._parts import Found, Joins
from fricmb.field._statements import Statements
from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.trajectory import Samples
from fricmb.scene import impact_law

#: Momentum that may be missing of an impact, and velocities by which its law may be missed, beside the largest.
MOMENTUM, LAW = 1e-12, 1e-9


class Impacts:
    """Checks at the instants of impacts; ``at`` (k,): the rows before them, each followed by that behind it."""

    def __init__(self, statements: Statements, units: Units, gathered: Gathered, rows: Samples) -> None:
        self.statements, self.units, self.gathered, self.rows = statements, units, gathered, rows
        law = impact_law(statements.scene.parts)
        self.poisson, self.in_turn = law.law == "poisson", law.several == "in_turn"
        self.rigid = {joint.name: joint for joint in statements.joints if joint.impact is not None}

    def look(self, events: Any) -> Ints:
        """All impacts; the rows before them."""
        if not self.rigid:
            return np.zeros(0, np.int64)
        twice = np.flatnonzero(np.diff(self.rows.t) == 0.0)
        hits: dict[int, list[Any]] = {}
        for event in events.of(kind="impact"):
            if event.t <= self.rows.t[0]:  # what begins with an impact begins behind it
                continue
            near = int(np.argmin(np.abs(self.rows.t[twice] - event.t))) if twice.size else -1
            found = near >= 0 and abs(self.rows.t[twice[near]] - event.t) <= ROUND_OFF * abs(event.t)
            self.gathered.add("impacts are at steps", [0.0 if found else np.inf], event.t, event.contact)
            if found:
                hits.setdefault(int(twice[near]), []).append(event)
        rests: dict[Any, list[float]] = {}
        for event in events.of(kind="rest"):
            rests.setdefault((event.contact, event.side), []).append(event.t - event.left)
        for i, those in hits.items():
            self._instant(i, those, rests)
        return np.array(sorted(hits), dtype=np.int64)

    def _instant(self, i: int, hits: list[Any], rests: Any) -> None:
        """One instant: impulses of its events against the jump of velocities."""
        s, t = self.statements, float(self.rows.t[i])
        before, behind = (s.moment(take(self.rows, [j])) for j in (i, i + 1))
        first, last = s.found(before), s.found(behind)
        jump = s.momentum(behind.v - before.v)[:, 0]
        push, lost = np.zeros_like(jump), 0.0
        speed = max(float(np.abs(first.phi_dot[self._joint_of(hit).name]).max()) for hit in hits)
        for hit in hits:
            joint = self._joint_of(hit)
            rows = [(first.phi_rows[joint.name][0], hit.impulse)]
            rates = [(first.phi_dot[joint.name][0, 0], last.phi_dot[joint.name][0, 0], hit.impulse)]
            if joint.contact is not None:
                rows.append((first.rows[joint.contact][0], hit.tangential_impulse))
                rates.append((first.g[joint.contact][0, 0], last.g[joint.contact][0, 0], hit.tangential_impulse))
            for row, impulse in rows:
                _push(push, row, impulse)
            loss = -0.5 * sum(impulse * (a + b) for a, b, impulse in rates)
            lost += loss
            scale = sum(abs(impulse) * (abs(a) + abs(b) + speed) for a, b, impulse in rates) + 1e-300
            self.gathered.add("loss of impacts", [abs(loss - hit.loss) / (LAW * scale)], t, hit.contact)
            self._law(hit, joint, rates, before, rests, speed)
        left = self._unheld(jump - push, first)
        # what slips by round-off of the run's speeds is brought to rest
        most = s.momentum(np.abs(self.rows.v).max(axis=1, keepdims=True))
        size = np.abs(jump).max(initial=0.0) + np.abs(push).max(initial=0.0) + np.abs(most).max(initial=0.0) + 1e-300
        names = s.names.dofs
        worst = int(np.argmax(np.abs(left)))
        self.gathered.add("momentum in impacts", [np.abs(left).max() / (MOMENTUM * size)], t, names[worst])
        energy = 0.5 * float(np.sum(np.abs(before.v[:, 0] * s.momentum(before.v)[:, 0]))) + 1e-300
        self.gathered.add("impacts take energy", [max(-lost, 0.0) / (LAW * energy)], t, hits[0].contact)
        self._others(hits, first, last, t)

    def _joint_of(self, hit: Any) -> Joins:
        name = f"{hit.contact}.{hit.side}"
        return self.rigid[name if name in self.rigid else hit.contact]

    def _law(self, hit: Any, joint: Joins, rates: list[Any], before: Moment, rests: Any, speed: float) -> None:
        """The speed behind is e times that before, or 0 where bounces end; friction is within its cone."""
        a, b, _ = rates[0]
        e, e_t, mu = joint.impact or (0.0, 0.0, 0.0)
        t = float(before.t[0])
        ends = any(abs(rest - t) <= ROUND_OFF * abs(t) for rest in rests.get((hit.contact, hit.side), ()))
        wanted = 0.0 if ends else -e * min(a, 0.0)
        size = abs(a) + speed + self._grain(joint, before)
        # of impulses that are shared Poisson's law says no speed of a contact: it may leave, and does not go in; nor
        # does any law of several impacts in turn, of which the sum is kept
        several = self.in_turn and hit.others > 0
        shared = several or (self.poisson and (hit.others > 0 or len(rates) > 1))
        missed = max(-b, 0.0) if shared else abs(b - wanted)
        self.gathered.add("law of impact", [missed / (LAW * size)], t, hit.contact)
        if len(rates) == 1 or ends:
            return
        slip_before, slip, along = rates[1]
        if np.isnan(mu) and joint.contact is not None:
            mu = float(self.statements.contacts[joint.contact].law.numeric().slip_limit())
        over = max(abs(along) - mu * hit.impulse, 0.0) / (LAW * hit.impulse)
        self.gathered.add("cone in impacts", [over], t, hit.contact)
        if self.poisson or several:  # slip may turn round between the two phases
            return
        xi = slip + e_t * slip_before
        sticks = abs(xi) <= LAW * (abs(slip_before) + size) * LIMIT
        against = abs(along + np.sign(xi) * mu * hit.impulse) / (LAW * hit.impulse)
        self.gathered.add("slip in impacts", [0.0 if sticks else against], t, hit.contact)

    def _grain(self, joint: Joins, before: Moment) -> float:
        """Speed that is none, of what is hit while it is held."""
        row = [(i, c) for form in joint.forms for i, c in before.form(form)[2]]
        return float(np.max(row_unit(row, self.units.v, before.t.shape))) + 1e-300

    def _others(self, hits: list[Any], first: Found, last: Found, t: float) -> None:
        """What touches and takes no impulse does not go in."""
        mine = {self._joint_of(hit).name for hit in hits}
        speed = max(abs(first.phi_dot[name][0, 0]) for name in mine)
        for name in self.rigid:
            row = first.phi_rows[name][0]
            touches = abs(first.phi[name][0, 0]) <= float(row_unit(row, self.units.q * 1e-3, (1,))[0])
            if name not in mine and touches:
                inward = max(-last.phi_dot[name][0, 0], 0.0)
                self.gathered.add("law of impact", [inward / (LAW * speed + 1e-300)], t, name)

    def _unheld(self, left: Floats, found: Found) -> Floats:
        """What is missing of momentum beside impulses of joints that hold both ways."""
        held = [row for j in self.statements.joints if not j.one_sided for row in found.phi_rows[j.name]]
        if not held or not left.any():
            return left
        pulls = np.zeros((left.size, len(held)))
        for column, row in enumerate(held):
            _push(pulls[:, column], row, 1.0)
        root = np.sqrt(self.statements.weight)
        scaled, pulls = left / root, pulls / root[:, None]
        found_left: Floats = (scaled - pulls @ np.linalg.lstsq(pulls, scaled, rcond=1e-10)[0]) * root
        return found_left


def _push(target: Floats, row: Row, impulse: float) -> None:
    """Add an impulse on a motion to the degrees of freedom behind it."""
    for i, c in row:
        target[i] += np.asarray(c).reshape(-1)[0] * impulse
