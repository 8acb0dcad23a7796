"""References of the brake, case 2, with a static friction above the kinetic one and with a Stribeck law.

Each by two methods that share no code: Taylor series in 34 digits and Gauss-Legendre collocation in long double.  They
must agree to 12 digits of every signal's largest value, and of every transition; the first is written, with the growth
of errors of the initial state (from eight neighbouring runs of the second).  Five minutes; run it from the root:

    python tools/references/make_brakes.py
"""

from pathlib import Path

import brake_gauss as gauss
import brake_taylor as taylor
import mpmath as mp
import numpy as np

T_END = 700
L = np.longdouble
DATA = Path(__file__).parents[2] / "fricmb" / "bench" / "data"
#: static, kinetic friction force, and v_s of a Gaussian Stribeck law
CASES = {"brake2_static": (20, 15, None), "brake2_stribeck": (18, 12, 1)}


def brake(module, number, static, kinetic, v_s):
    """The brake of one of the two programs."""
    return module.Brake(static=number(static), kinetic=number(kinetic), v_s=None if v_s is None else number(v_s))


def long_double(value):
    """Of an mpmath number."""
    return L(mp.nstr(value, 25))


def growth(system, states, grid):
    """Largest growth of a relative error of the initial state (all but the rotor's position, which shifts alone)."""
    size = np.abs(states).max(axis=0)
    found = []
    for i in range(8):
        start = gauss.START.copy()
        start[i] += L("1e-9") * size[i]
        moved, _ = gauss.solve(system, T_END, grid, start)
        found.append(float((np.abs(moved - states) / size).max() / 1e-9))
    return max(found)


def force(system, states, stuck):
    """Friction force on the pad (n_t, 2)."""
    g = states[:, 4:6] - states[:, 6:]
    r = np.sqrt((g * g).sum(axis=1))
    sliding = -(system.limit(r)[0] / np.where(r > 0, r, 1))[:, None] * g
    return np.where(stuck[:, None], np.array([system.held(y) for y in states]), sliding)


def make(name):
    """Solve a case both ways, compare, and write its file."""
    grid = [k / mp.mpf(2) for k in range(2 * T_END + 1)]
    rows, events = taylor.solve(brake(taylor, mp.mpf, *CASES[name]), T_END, grid)
    states = np.array([[long_double(c) for c in (*q, *v)] for q, v in rows])
    times = np.array([long_double(t) for t, _ in events])
    system, times_grid = brake(gauss, L, *CASES[name]), np.arange(2 * T_END + 1).astype(L) / 2
    others, other_events = gauss.solve(system, T_END, times_grid)
    assert [kind for _, kind in events] == [kind for _, kind in other_events]
    apart = (np.abs(states - others).max(axis=0) / np.abs(states).max(axis=0)).max()
    apart_t = np.abs(times - np.array([t for t, _ in other_events])).max()
    print(f"{name}: {len(events)} transitions; the methods differ by {apart:.1e} of the largest, {apart_t:.1e} in time")
    assert apart < 1e-12
    assert apart_t < 1e-12 * T_END
    begun = np.searchsorted(times, times_grid, side="right")
    F = force(system, states, (begun % 2 == 1) & (begun > 0))
    grows = growth(system, states, times_grid)
    print(f"  growth of errors: {grows:.3g}")
    np.savez_compressed(
        DATA / f"{name}.npz", t=times_grid.astype(float), q=states[:, :4].T.astype(float),
        v=states[:, 4:].T.astype(float), F=F.T.astype(float), t_event=times.astype(float),
        contact_event=np.zeros(len(times), np.int64), growth=np.array([grows]), digits=np.array(1e-15),
        kind_event=np.array([0 if kind == "stick" else 1 for _, kind in events]),
    )  # fmt: skip


if __name__ == "__main__":
    for name in CASES:
        make(name)
