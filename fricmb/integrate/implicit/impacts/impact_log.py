"""What is kept of the impacts of a run, and their places among its other transitions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.integrate.event_kinds import EVENT_CLOSE, EVENT_IMPACT, EVENT_OPEN, EVENT_REST
from fricmb.integrate.implicit.impacts.impact_law import Answer
from fricmb.integrate.implicit.impacts.impact_rest import Hop
from fricmb.integrate.mechanism import RIGID, Joints
from fricmb.integrate.problem import Codes, Floats, Ints, Problem
from fricmb.integrate.trajectory import IMPACT_COLUMNS, Transitions

#: Impulse that is none, beside the largest at the instant.
NOTHING = 1e-13


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """One instant: impulses, rows of slip (k,) or -1, and energy lost by each row (r,)."""

    answer: Answer
    tangential: Ints
    lost: Floats


class ImpactLog:
    """Impacts in the order in which they happen."""

    def __init__(self, problem: Problem, joints: Joints) -> None:
        self._problem, self._joints = problem, joints
        self._rows: list[list[float]] = []
        self._several: list[float] = []
        self._bear: dict[str, None] = {}
        self._order: dict[float, tuple[str, ...]] = {}

    def add(
        self, t: float, members: Ints, rested: Iterable[bool], approach: Floats, outcome: Outcome,
        hops: list[Hop | None],
    ) -> None:  # fmt: skip
        """One instant; ``rested`` (k,) what is held anew, ``approach`` (k,) speeds before."""
        answer, n_c = outcome.answer, self._problem.n_c
        impulse = answer.impulse[: len(members)]
        hit = np.abs(impulse) > NOTHING * float(impulse.max(initial=0.0))
        if answer.others:
            self._several.append(t)
        for i, rests in enumerate(rested):
            j, b = int(members[i]), int(outcome.tangential[i])
            common = [float(approach[i]), 0.0, 0.0, 0.0, float(hit.sum() - 1), float(self._joints.side[j])]
            if hit[i]:
                common[1] = outcome.lost[i] + (outcome.lost[b] if b >= 0 else 0.0)
                slip = answer.impulse[b] if b >= 0 else 0.0
                self._rows.append([t, n_c + j, EVENT_IMPACT, impulse[i], slip, *common])
            if rests:
                hop = hops[i] or Hop(ends=True)
                common[1:4] = [0.0, hop.left, hop.bound]
                self._rows.append([t + hop.left, n_c + j, EVENT_REST, 0.0, 0.0, *common])

    def add_alone(self, t: float, found: Floats) -> None:
        """An impact of one contact that bounces on (see ``impact_alone``)."""
        normal, along, approach, lost, which = found.tolist()
        j = int(which)
        side = float(self._joints.side[j])
        self._rows.append([t, self._problem.n_c + j, EVENT_IMPACT, normal, along, approach, lost, 0.0, 0.0, 0.0, side])

    def depend_on_order(self, t: float, names: Iterable[str]) -> None:
        """Note that these are hit at one instant, and that in turn they would leave with other speeds."""
        self._order.setdefault(t, tuple(dict.fromkeys(names)))

    def bear_impulses(self, names: Iterable[str]) -> None:
        """Note that the friction of these joints takes no part."""
        self._bear |= dict.fromkeys(names)

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences about impacts for the user."""
        found = []
        if self._several:
            more = f" and {len(self._several) - 1} more times" if len(self._several) > 1 else ""
            found.append(
                f"the law of impact has several solutions at t = {self._several[0]:.6g}{more}: the one that sticks most"
                " is taken"
            )
        if self._order:
            t, hit = next(iter(self._order.items()))
            more = f" and {len(self._order) - 1} more times" if len(self._order) > 1 else ""
            found.append(
                f"{', '.join(map(repr, hit))} are hit at one instant, t = {t:.6g}{more}, to round-off: they share"
                " the impact; one after the other (fm.ImpactLaw with several='in_turn') they leave with other speeds"
            )
        if self._bear:
            names = ", ".join(map(repr, self._bear))
            found.append(
                f"joints bear impulses in impacts, and the friction that belongs to them is left out: that of {names}"
            )
        return tuple(found)

    def transitions(self, found: Transitions, t: Floats, opened: Codes, t_end: float) -> Transitions:
        """Those of the run with impacts in their places; ``t`` (k,), ``opened`` (k, n_j): starts of steps."""
        rows = np.array([row for row in self._rows if row[0] <= t_end]).reshape(-1, len(IMPACT_COLUMNS))
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        mine = self._kept(found)
        let_go = self._let_go(t, opened)
        # of one instant the impact comes first: contacts reverse or stick because of it
        time = np.concatenate([rows[:, 0], found.t[mine], let_go[:, 0]])
        contact = np.concatenate([rows[:, 1], found.contact[mine], let_go[:, 1]]).astype(int)
        kind = np.concatenate([rows[:, 2], found.kind[mine], np.full(len(let_go), EVENT_OPEN)]).astype(int)
        order = np.argsort(time, kind="stable")
        return Transitions(t=time[order], contact=contact[order], kind=kind[order], impacts=rows)

    def _kept(self, found: Transitions) -> Any:
        """Events of the loop that are none of a rigid joint that closes: "rest" tells of that."""
        rigid = np.zeros(self._problem.n_c + 1, bool)
        port = self._joints.port[self._joints.hands_over == RIGID]
        rigid[port[port >= 0]] = True
        return ~((found.kind == EVENT_CLOSE) & rigid[found.contact])

    def _let_go(self, t: Floats, opened: Codes) -> Floats:
        """Times and numbers of rigid joints without friction that have been held and let go (n, 2)."""
        mine = np.flatnonzero((self._joints.hands_over == RIGID) & (self._joints.port < 0))
        step, which = np.nonzero(np.diff(opened[:, mine].astype(int), axis=0) > 0)
        return np.stack([t[step + 1], self._problem.n_c + mine[which]], axis=1)
