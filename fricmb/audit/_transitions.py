"""What happens where a contact changes its mode: it had to, and nothing jumps."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.audit._gather import Gathered
from fricmb.audit._impacts import Impacts
from fricmb.audit._points import row_unit
from fricmb.audit._release import group_spare, holding
from fricmb.audit._units import ROUND_OFF, Units
from fricmb.field._contacts import Rubs
from fricmb.field._motions import Moment
from fricmb.field._statements import Statements
from fricmb.integrate.problem import OPEN, SLIP, STICK, Floats, Ints
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.trajectory import Samples

#: Changes of mode that are looked at in all contacts, and places within a step at which a release is tried.
_CHANGES, _PLACES = 80, 5
#: What a group may have to spare when it lets go, in parts of its limits, beside what the tolerance makes of that.
_GROUP = 1e-6
#: Part of a jump of velocities that is round-off of the equations it is split with.
_DIGITS = 1e-12


class Changes:
    """Changes of mode from row to row; a transition that was located has two rows at its instant."""

    def __init__(self, statements: Statements, units: Units, gathered: Gathered, rows: Samples, sample: Any) -> None:
        self.statements, self.units, self.gathered = statements, units, gathered
        self.rows, self.sample = rows, sample

    def look(self, events: Any, rng: np.random.Generator) -> None:
        """All contacts; ``events`` are those of the run."""
        impacts = Impacts(self.statements, self.units, self.gathered, self.rows).look(events)
        self._jumps(impacts)
        room = max(2, _CHANGES // max(1, len(self.statements.contacts)))
        for k, law in self.statements.contacts.items():
            mode = self.rows.mode[k]
            at = np.flatnonzero(mode[1:] != mode[:-1])
            self._named(law, at, events.of(contact=law.name))
            if law.smooth:
                continue
            chosen = np.sort(rng.choice(at, room, replace=False)) if at.size > room else at
            caught = chosen[(mode[chosen] == SLIP) & (mode[chosen + 1] == STICK)]
            located = caught[self.rows.t[caught] == self.rows.t[caught + 1]]
            self._caught(k, law, np.setdiff1d(located, impacts))
            let_go = chosen[(mode[chosen] == STICK) & (mode[chosen + 1] == SLIP)].tolist()
            for i in let_go:
                self._released(k, law, i, i + 1, rng)
            if mode[0] == SLIP and self.rows.t.size > 1:
                self._released(k, law, 0, 0, rng)

    def _jumps(self, impacts: Ints) -> None:
        """Positions and velocities where rows stand at one instant; velocities jump behind the rows of ``impacts``."""
        rows = self.rows
        every = np.flatnonzero(np.diff(rows.t) == 0.0)
        for name, values, unit in (("q", rows.q, self.units.q), ("v", rows.v, self.units.v)):
            twice = np.setdiff1d(every, impacts) if name == "v" else every
            jump = np.abs(values[:, twice + 1] - values[:, twice])
            if name == "v" and self.statements.joints:
                jump = np.abs(self._without_impulses(values[:, twice + 1] - values[:, twice], twice))
            # what never moves jumps by the round-off of what does
            weight = np.where(self.statements.weight > 0.0, self.statements.weight, np.inf)[:, None]
            grain = (
                ROUND_OFF * np.sqrt((weight * rows.v**2).sum(axis=0).max(initial=0.0) / weight) if name == "v" else 0.0
            )
            jump = np.where(jump > grain, jump, 0.0)
            ratio = np.where(jump > 0.0, jump / (2.0 * unit[:, None] + 1e-300), 0.0)
            if twice.size:
                i = int(np.argmax(ratio.max(axis=1)))
                self.gathered.add(f"continuity of {name}", ratio[i], rows.t[twice], self.statements.names.dofs[i])

    def _without_impulses(self, jump: Floats, twice: Ints) -> Floats:
        """What jumps of v (n, n_t) are beside those by which joints follow a prescribed speed that jumps."""
        s, rows = self.statements, self.rows
        breaks = s.frame.breaks
        for i, at in enumerate(twice.tolist()):
            t = float(rows.t[at])
            if not breaks.size or np.abs(breaks - t).min() > ROUND_OFF * abs(t):
                continue
            found = s.found(s.moment(take(rows, [at + 1])))
            pulls = np.zeros((s.weight.size, sum(len(found.phi_rows[joint.name]) for joint in s.joints)))
            each = (row for joint in s.joints for row in found.phi_rows[joint.name])
            for column, row in enumerate(each):
                for k, c in row:
                    pulls[k, column] += np.asarray(c).reshape(-1)[0]
            root = np.sqrt(s.weight)
            pulls /= root[:, None]
            scaled = root * jump[:, i]
            left = scaled - pulls @ np.linalg.lstsq(pulls, scaled, rcond=1e-10)[0]
            jump[:, i] = np.where(np.abs(left) > _DIGITS * np.linalg.norm(scaled), left / root, 0.0)
        return jump

    def _named(self, law: Rubs, at: Ints, events: Any) -> None:
        """Every change of mode is among the events."""
        t = self.rows.t
        known = np.asarray(events.t, dtype=float)
        margin = 1e-10 * (np.abs(t[[0, -1]]).max() + t[-1] - t[0])
        low = np.searchsorted(known, t[at] - margin, side="left")
        high = np.searchsorted(known, t[at + 1] + margin, side="right")
        self.gathered.add("changes of mode are events", np.where(high > low, 0.0, np.inf), t[at], law.name)

    def _caught(self, k: int, law: Rubs, at: Ints) -> None:
        """A contact that sticks from now on has come to rest."""
        if not at.size:
            return
        s = self.statements
        found = s.found(s.moment(take(self.rows, at)))
        unit = np.array([row_unit(row, self.units.v, (at.size,)) for row in found.rows[k]])
        ratio = (np.abs(found.g[k]) / (2.0 * unit + 1e-300)).max(axis=0)
        self.gathered.add("rest where slip ends", ratio, self.rows.t[at], law.name)

    def _released(self, k: int, law: Rubs, i: int, j: int, rng: np.random.Generator) -> None:
        """A contact that slips from now on could not have been held."""
        s, rows = self.statements, self.rows
        before, after = take(rows, [i]), take(rows, [j])
        if self._group_released(law, i, j):
            return
        own = slice(int(s.names.row[k]), int(s.names.row[k + 1]))
        if i != j and self._at_limit(law, k, before, own):
            return
        last = int(np.searchsorted(rows.t, rows.t[j], side="right"))
        h = float(rows.t[min(last, rows.t.size - 1)] - rows.t[j])
        if h <= 0.0:
            return
        located = rows.t[i] == rows.t[j]
        begin = after if located else before
        stuck = [c for c in s.contacts if rows.mode[c, j] == STICK and not s.contacts[c].smooth]
        span = rows.t[j] - rows.t[i]
        times = [rows.t[j] + 1e-9 * h] if located else (rows.t[i] + span * np.linspace(1.0, 1e-9, _PLACES)).tolist()
        least = np.inf
        for t in times:
            moment = self._state_before_at(s.moment(begin), s.moment(after), float(t))
            found = s.found(moment)
            unit = np.array([row_unit(row, self.units.v, (1,)) for row in found.rows[k]])
            if (np.abs(found.g[k]) > 2.0 * unit + 1e-300).any() or rows.mode[k, j] == OPEN:
                return  # slips because what it rubs on moves
            short = self._short(k, law, moment, stuck, h, rng)
            if short is None:
                return
            least = min(least, short)
            if least <= 0.0:
                break
        self.gathered.add("release from stick", [max(least, 0.0)], float(rows.t[j]), law.name)

    def _group_released(self, law: Rubs, i: int, j: int) -> bool:
        """What rested with others could not have been held by them, whatever share each bears.

        True where several let go as one, so that each alone could perhaps be held beside the slip of the others.
        """
        s, rows = self.statements, self.rows
        group = [c for c in s.contacts if rows.mode[c, i] == STICK and not s.contacts[c].smooth]
        if i == j or len(group) < 2 or rows.t[i] != rows.t[j]:
            return False
        last = int(np.searchsorted(rows.t, rows.t[j], side="right"))
        h = float(rows.t[min(last, rows.t.size - 1)] - rows.t[j])
        moment = s.moment(take(rows, [i]))
        found = s.found(moment)
        for c in group:
            unit = np.array([row_unit(row, self.units.v, (1,)) for row in found.rows[c]])
            if h <= 0.0 or (np.abs(found.g[c]) > 2.0 * unit + 1e-300).any():
                return False
        spare = group_spare(s, moment, group, h)
        if spare is None:
            return False
        unit_of_spare = _GROUP + self.units.rtol
        self.gathered.add("release of a group", [max(spare, 0.0) / unit_of_spare], float(rows.t[j]), law.name)
        return sum(int(rows.mode[c, j] == SLIP) for c in group) > 1

    def _at_limit(self, law: Rubs, k: int, before: Samples, own: slice) -> bool:
        size = law.held(before.F[own] * self.statements.names.row_scale[own], before.N[k])
        limit = law.limit(before.N[k])
        return bool(size[0] >= limit[0] * (1.0 - self.units.rtol) - self._force_unit(own))

    def _force_unit(self, own: slice) -> float:
        return float(self.units.F[own].max(initial=0.0))

    @staticmethod
    def _state_before_at(begin: Moment, after: Moment, t: float) -> Moment:
        """The state before, at a time after it, with the friction that other contacts have there."""
        values = {name: value for name, value in vars(begin).items() if name != "_places"}
        step = np.array([t]) - begin.t
        return Moment(**{**values, "t": np.array([t]), "q": begin.q + step * begin.v, "F": after.F})

    def _short(
        self, k: int, law: Rubs, moment: Moment, stuck: list[int], h: float, rng: np.random.Generator
    ) -> float | None:
        """Units by which the friction that would hold falls short of its limit; None where it is not determined."""
        held = holding(self.statements, moment, k, stuck, h)
        if held is None:
            return None
        force, N = held
        limit = float(law.limit(np.array([N]))[0])
        unit = self.units.rtol * limit + 1e-7 * float(np.linalg.norm(force)) + 1e-300
        size = float(law.held(force[:, None], np.array([N]))[0])
        over = (limit - size) / unit
        for _ in range(2 if over > 1.0 else 0):
            moved = holding(self.statements, self.units.perturbed(moment, rng), k, stuck, h)
            if moved is not None:
                shift = float(np.linalg.norm(moved[0] - force)) + abs(float(law.limit(np.array([moved[1]]))[0]) - limit)
                unit = max(unit, self.units.rtol * limit + shift)
        return (limit - size) / unit


def opening(rows: Samples, k: int) -> Floats:
    """Times (n,) at which contact k begins to slip, two rows at an instant."""
    mode = rows.mode[k]
    found: Floats = rows.t[1:][(mode[:-1] == STICK) & (mode[1:] == SLIP) & (np.diff(rows.t) == 0.0)]
    return found
