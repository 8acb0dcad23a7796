"""References of pad and rotor: three contacts that slide; one that sticks and slips before the rotor stands.

By Taylor series in 34 digits and by Gauss-Legendre collocation in long double, which must agree; run from the root:

    python tools/references/make_pad_rotor.py
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
import pad_rotor_gauss as gauss
import pad_rotor_taylor as taylor
from brake_gauss import L

from fricmb import models

DATA = Path(__file__).parents[2] / "fricmb" / "bench" / "data"
RINGING = {"mode3": 2.0, "mode5": 1.0}
SLIDES = {"n_pad_modes": 4, "n_rotor_modes": 6, "n_contacts": 3, "speed": 1.0, "rotor_velocity": RINGING}
STOPS = {"n_pad_modes": 3, "n_rotor_modes": 4, "n_contacts": 1, "speed": 0.5, "rotor_velocity": RINGING}
#: arguments of the model, t_end, points of the grid, longest step, step at the beginning of slip
CASES = {"pad_rotor_slides": (SLIDES, 0.01, 400, 4e-6, 0.0), "pad_rotor_stops": (STOPS, 0.02, 800, 4e-6, 1e-7)}


@dataclass(frozen=True, kw_only=True)
class System:
    """Numbers of one kind: modes with masses of 1, contacts (g = W v), friction forces."""

    omega: Any
    damping: Any
    W: Any
    static: Any
    kinetic: Any
    speed: Any
    longest: Any
    delassus: Any = None
    compliance: Any = None
    units: Any = None
    first: Any = None

    def rest(self, v):
        """The velocities without the relative velocity of the one contact."""
        g = mp.matrix([mp.fdot(zip(row, v, strict=True)) for row in self.W[0]])
        push = mp.lu_solve(self.delassus, g)
        return [c - self.W[0][0][j] * push[0] - self.W[0][1][j] * push[1] for j, c in enumerate(v)]


def numbers(arguments):
    """omega, damping, W, static, kinetic and initial velocities of the model, in double precision."""
    scene = models.pad_rotor(**arguments)
    pad, rotor = (next(part for part in scene.parts if part.name == name) for name in ("pad", "rotor"))
    omega = np.concatenate([pad.frequencies, rotor.frequencies])
    ratios = np.concatenate([np.broadcast_to(b.damping_ratios, np.shape(b.frequencies)) for b in (pad, rotor)])
    contacts = [part for part in scene.parts if part.name.startswith("c") and hasattr(part, "law")]
    places = [f"p{c.name[1:]}" for c in contacts]
    W = np.array([np.hstack([pad.shapes[p], -np.asarray(rotor.shapes[p])]) for p in places])
    N = np.array([float(c.normal_force) for c in contacts])
    v = np.zeros(len(omega))
    for mode, speed in rotor.velocity.items():
        v[len(pad.frequencies) + int(mode[4:]) - 1] = speed
    law = contacts[0].law
    return omega, 2 * ratios * omega, W, float(law.mu_s) * N, float(law.mu_k) * N, v


def systems(arguments, longest, first):
    """The system in 34 digits and in long double, and initial velocities."""
    omega, damping, W, static, kinetic, v = numbers(arguments)
    speed = np.abs(np.einsum("kin,n->ki", W, v)).max()

    def exact(array):
        return [exact(row) if np.ndim(row) else mp.mpf(float(row)) for row in array]

    rows = exact(W)
    D = mp.matrix([[mp.fdot(zip(a, b, strict=True)) for b in rows[0]] for a in rows[0]])
    series = System(
        omega=exact(omega), damping=exact(damping), W=rows, static=exact(static), kinetic=exact(kinetic),
        speed=mp.mpf(float(speed)), longest=mp.mpf(longest), delassus=D,
    )  # fmt: skip
    inverse = D**-1
    compliance = np.array([[long_double(inverse[i, j]) for j in (0, 1)] for i in (0, 1)])
    least = max(omega[omega > 0].min(), 1.0)
    stages = System(
        omega=omega.astype(L), damping=damping.astype(L), W=W.astype(L), static=static.astype(L),
        kinetic=kinetic.astype(L), speed=L(speed), longest=L(longest), compliance=compliance, first=L(first),
        units=np.concatenate([np.full(len(v), np.abs(v).max() / least), np.full(len(v), np.abs(v).max())]).astype(L),
    )  # fmt: skip
    return series, stages, v


def long_double(value):
    """Of an mpmath number."""
    return L(mp.nstr(value, 25))


def growth(stages, states, v, grid):
    """Largest growth of a relative error of an initial velocity."""
    size = np.abs(states).max(axis=0)
    found = []
    for i in range(len(v)):
        moved = v.astype(L)
        moved[i] += L("1e-9") * size[len(v) + i]
        other, _ = gauss.solve(stages, np.zeros(len(v), dtype=L), moved, grid)
        found.append(float((np.abs(other - states) / size).max() / 1e-9))
    return max(found)


def make(name):
    """Solve a case both ways, compare, and write its file."""
    arguments, t_end, count, longest, first = CASES[name]
    series, stages, v = systems(arguments, longest, first)
    grid = [k * mp.mpf(t_end) / count for k in range(count + 1)]
    rows, forces, events = taylor.solve(series, [mp.mpf(0)] * len(v), [mp.mpf(float(c)) for c in v], grid)
    states = np.array([[long_double(c) for c in (*q, *w)] for q, w in rows])
    times = np.array([long_double(t) for t, _ in events])
    plain = np.array([long_double(t) for t in grid])
    others, other_events = gauss.solve(stages, np.zeros(len(v), dtype=L), v.astype(L), plain)
    size = np.maximum(np.abs(states).max(axis=0), 1e-30)
    apart = (np.abs(states - others).max(axis=0) / size).max()
    late = max((abs(float(a - b[0])) for a, b in zip(times, other_events, strict=True)), default=0.0)
    print(f"{name}: {len(events)} transitions; the methods differ by {apart:.1e} of the largest, {late:.1e} s in time")
    assert [kind for _, kind in events] == [kind for _, kind in other_events]
    assert apart < 1e-12
    assert late < 1e-12 * t_end
    grows = growth(stages, states, v, plain)
    print(f"  growth of errors: {grows:.3g}")
    F = np.array([[float(x) for pair in row for x in pair] for row in forces])
    np.savez_compressed(
        DATA / f"{name}.npz", t=plain.astype(float), q=states[:, : len(v)].T.astype(float),
        v=states[:, len(v) :].T.astype(float), F=F.T, t_event=times.astype(float), growth=np.array([grows]),
        contact_event=np.zeros(len(times), np.int64), digits=np.array(1e-14),
        kind_event=np.array([0 if kind == "stick" else 1 for _, kind in events], np.int64),
    )  # fmt: skip


if __name__ == "__main__":
    for name in CASES:
        make(name)
