"""What holds at every time: laws of friction and their cones, creep in stick, constraints of joints."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.audit._gather import Gathered
from fricmb.audit._units import ROUND_OFF, Units
from fricmb.field._contacts import Rubs
from fricmb.field._motions import Moment, Row
from fricmb.field._parts import Found
from fricmb.field._statements import Statements
from fricmb.integrate.problem import OPEN, SLIP, STICK, Floats
from fricmb.integrate.trajectory import Samples

#: A cone is searched at this many times of every step at most, and at so many in all.
_PER_STEP, _IN_ALL = 8, 40_000
#: Where sticking friction peaks above this share of its limit, it is looked at more closely.
_NEAR, _CLOSER, _PEAKS = 0.5, 8, 200
#: Steps no longer than this part of the time hold nothing but the way over a jump.
_CARRIED = 5e-10


def row_unit(row: Row, unit: Floats, shape: tuple[int, ...]) -> Floats:
    """What units of the degrees of freedom make of a motion (n_t,)."""
    total = np.zeros(shape)
    for i, c in row:
        total += np.abs(c) * unit[i]
    return total


class Points:
    """Checks at the times of moments."""

    def __init__(self, statements: Statements, units: Units, gathered: Gathered) -> None:
        self.statements, self.units, self.gathered = statements, units, gathered

    def look(self, samples: Samples, rng: np.random.Generator) -> None:
        """All that holds at given times."""
        s = self.statements
        moment = s.moment(samples)
        found = s.found(moment)
        moved = s.found(self.units.perturbed(moment, rng)) if s.contacts else found
        for k, law in s.contacts.items():
            unit = np.array([row_unit(row, self.units.v, moment.t.shape) for row in found.rows[k]])
            unit += ROUND_OFF * np.abs(s.names.row_scale[0, 0] * found.g[k])
            across = np.array([not row for row in found.rows[k]])
            if across.any():  # slip across a guide is prescribed: of no degree of freedom, and right to its own size
                unit[across] += self.units.rtol * np.abs(found.g[k][across]).max(axis=-1, keepdims=True)
            own = slice(int(s.names.row[k]), int(s.names.row[k + 1]))
            said = samples.g[own] / s.names.row_scale[own]
            self._compare("slip velocity", said, found.g[k], unit, moment.t, law.name)
            # of the largest, too: at a lift-off the load is a difference of forces of that size
            N_unit = np.abs(moved.N[k] - found.N[k]) + self.units.rtol * np.abs(found.N[k])
            N_unit += ROUND_OFF * np.abs(found.N[k]).max(initial=0.0)
            self._compare("normal force", moment.N[k], found.N[k], N_unit + 1e-300, moment.t, law.name)
            self._law(k, law, moment, found, unit, N_unit)
        for joint in s.joints:
            self._joint(joint, moment, found)

    def _compare(self, name: str, given: Floats, stated: Floats, unit: Any, t: Floats, part: str) -> None:
        difference = np.abs(given - stated)
        ratio = np.where(difference > 0.0, difference / (unit + 1e-300), 0.0)
        self.gathered.add(name, ratio.max(axis=0) if ratio.ndim > 1 else ratio, t, part)

    def _law(self, k: int, law: Rubs, moment: Moment, found: Found, unit: Floats, N_unit: Floats) -> None:
        s, mode, t = self.statements, moment.mode[k], moment.t
        F, g, N, z = s.forces(moment, k), found.g[k], found.N[k], s.states(moment, k)
        if law.smooth:
            slack = self._slack(k, law, g, N, z, unit, N_unit)
            self._compare("friction law", F, law.force(g, N, z), slack, t, law.name)
            return
        sliding, stuck, apart = mode == SLIP, mode == STICK, mode == OPEN
        if sliding.any():
            at = (slice(None), sliding)
            slack = self._slack(k, law, g[at], N[sliding], z[at], unit[at], N_unit[sliding])
            # at rest to the accuracy of the run a direction of slip is no more than the run's own
            stated = law.force(g[at], N[sliding], z[at])
            still = (np.abs(g[at]) <= unit[at]).all(axis=0)
            limit = law.limit(N[sliding])
            ends = still & (law.held(F[at], N[sliding]) <= limit + self.units.rtol * limit)
            self._compare("friction law", np.where(ends, stated, F[at]), stated, slack, t[sliding], law.name)
        if stuck.any():
            ratio = (np.abs(g[:, stuck]) / (2.0 * unit[:, stuck] + 1e-300)).max(axis=0)
            self.gathered.add("creep in stick", ratio, t[stuck], law.name)
        if apart.any():
            size = law.size(F[:, apart]) + N[apart]
            self.gathered.add(
                "open contacts", size / (N_unit[apart] + self._force_unit(k) + 1e-300), t[apart], law.name
            )

    def _force_unit(self, k: int) -> float:
        row = self.statements.names.row
        return float(self.units.F[row[k] : row[k + 1]].max(initial=0.0))

    def _slack(self, k: int, law: Rubs, g: Floats, N: Floats, z: Floats, unit: Floats, N_unit: Floats) -> Floats:
        """What units of velocity, load and states make of the law's force (n_t,), summed over them."""
        stated = law.force(g, N, z)
        total = np.full(stated.shape, self._force_unit(k))
        for i in range(len(g)):
            for sign in (-1.0, 1.0):
                moved = g.copy()
                moved[i] += sign * unit[i]
                total += np.abs(law.force(moved, N, z) - stated)
        total += np.abs(law.force(g, N + N_unit, z) - stated)
        start = int(self.statements.names.z_start[k])
        for i in range(len(z)):
            moved = z.copy()
            moved[i] += self.units.z[start + i]
            total += np.abs(law.force(g, N, moved) - stated)
        found: Floats = total.max(axis=0)
        return found

    def _joint(self, joint: Any, moment: Moment, found: Found) -> None:
        phi, rate = found.phi[joint.name], found.phi_dot[joint.name]
        if joint.impact is not None:
            self._rigid(joint, moment, found)
        held = np.abs(moment.lam[joint.name]) > 0.0 if joint.one_sided else np.ones(phi.shape, dtype=bool)
        for x, x_dot, row, there in zip(phi, rate, found.phi_rows[joint.name], held, strict=True):
            for values, unit in ((x, self.units.q), (x_dot, self.units.v)):
                size = row_unit(row, unit, moment.t.shape) + self._grain(row, moment)
                self.gathered.add(
                    "constraints", np.where(there, np.abs(values) / (2.0 * size), 0.0), moment.t, joint.name
                )

    def _rigid(self, joint: Any, moment: Moment, found: Found) -> None:
        """What is rigid is not entered, and only pushes."""
        (phi,), (row,), (lam,) = found.phi[joint.name], found.phi_rows[joint.name], moment.lam[joint.name]
        size = row_unit(row, self.units.q, moment.t.shape) + self._grain(row, moment)
        self.gathered.add("rigid surfaces are not entered", np.maximum(-phi, 0.0) / (2.0 * size), moment.t, joint.name)
        # where it lets go its force is what others leave of each other: their sizes count, not its own alone
        sizes = [np.abs(found.force[i]).max(initial=0.0) / (np.abs(c).max() + 1e-300) for i, c in row]
        unit = self.units.rtol * max(np.abs(lam).max(initial=0.0), *sizes) + 1e-300
        self.gathered.add("rigid surfaces only push", np.maximum(-lam, 0.0) / unit, moment.t, joint.name)

    @staticmethod
    def _grain(row: Row, moment: Moment) -> Floats:
        """Round-off of a motion: of what it is put together from."""
        total = np.full(moment.t.shape, ROUND_OFF)
        for i, c in row:
            total += ROUND_OFF * np.abs(c) * (1.0 + np.abs(moment.q[i]) + np.abs(moment.v[i]))
        return total

    # -- cones over the whole run -------------------------------------------------------------------------------
    def cones(self, rows: Samples, sample: Any) -> None:
        """Sticking friction against its limit in every step, and closely around its peaks."""
        s = self.statements
        hard = {k: law for k, law in s.contacts.items() if not law.smooth}
        if not hard or rows.t.size < 2:
            return
        for k, law in hard.items():
            self._cone(k, law, rows)
        h = np.diff(rows.t)
        # where forces jump a state is carried over the place in the modes that it had, by some roundings of the time
        real = h > _CARRIED * np.abs(rows.t[1:])
        steps = np.flatnonzero(real & (rows.mode[list(hard)] == STICK).any(axis=0)[:-1])
        room = max(int(_IN_ALL // max(1, len(s.names.contacts))), 200)
        if steps.size > room:
            steps = steps[:: -(-steps.size // room)]
        if not steps.size:
            return
        count = int(np.clip(room // steps.size, 1, _PER_STEP))
        inside = (np.arange(count) + 0.5) / count
        t = (rows.t[steps][:, None] + h[steps][:, None] * inside).ravel()
        seen = sample(t)
        peaks = []
        for k, law in hard.items():
            share = self._cone(k, law, seen)
            inner = (
                (share[1:-1] >= share[:-2]) & (share[1:-1] >= share[2:]) & (share[1:-1] > _NEAR) & (share[1:-1] <= 1.0)
            )
            peaks.append(np.flatnonzero(inner) + 1)
        top = np.unique(np.concatenate(peaks))
        top = top[:: -(-top.size // _PEAKS)] if top.size > _PEAKS else top
        if top.size:
            low, high = t[top - 1], t[top + 1]
            fine = (low[:, None] + (high - low)[:, None] * (np.arange(2 * _CLOSER) + 0.5) / (2 * _CLOSER)).ravel()
            closer = sample(fine)
            for k, law in hard.items():
                self._cone(k, law, closer)

    def _cone(self, k: int, law: Rubs, samples: Samples) -> Floats:
        """Share of the limit (n_t,) that sticking friction takes; gathered where it is above."""
        names = self.statements.names
        own = slice(int(names.row[k]), int(names.row[k + 1]))
        stuck = samples.mode[k] == STICK
        size = law.held(samples.F[own] * names.row_scale[own], samples.N[k])
        limit = law.limit(samples.N[k])
        unit = self.units.rtol * limit + self._force_unit(k) + 1e-300
        share = np.where(stuck, size / (limit + 1e-300), 0.0)
        over = np.where(stuck, np.maximum(size - limit, 0.0) / unit, 0.0)
        self.gathered.add("cone of friction", over, samples.t, law.name)
        found: Floats = np.where(limit > 0.0, share, 0.0)
        return found
