r"""
Collocation of port forces
==========================

What the integrator of :doc:`/explanation/collocation` does, in four pictures: how the direction of slip settles before
a landing, what the error of one step depends on, what the exact structure is worth over a whole run, and where the
method is the fastest.
"""

import json
import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from numpy.polynomial import legendre
from scipy.linalg import expm

import fricmb as fm
from fricmb.integrate.collocation import Collocation

# %%
# **Landing.**  A mass on two springs slides to rest.  Seen over the time that is left, the direction of slip settles
# like a broken power: no polynomial follows that at any fixed step, so steps shorten geometrically, and a last short
# rest is crossed in one.

scene = fm.models.planar_oscillator(friction=0.3, position=(2.0, 0.0), velocity=(0.0, 1.7))
method = Collocation(general=True)
sol = fm.simulate(scene, t_end=20.0, rtol=1e-8, method=method)
rest = sol.events.of(kind="stick").t[-1]
left = np.geomspace(3.0, 1e-6, 400)
dense = fm.simulate(scene, t_end=20.0, rtol=1e-11, t_eval=np.sort(rest - left), method=method)
direction = np.unwrap(np.arctan2(*-dense.force("sole")[::-1]))
before = (sol.t < rest - 1e-6) & (sol.t > rest - 3.0)
angles = np.interp(sol.t[before], dense.t, direction)

figure, ax = plt.subplots(figsize=(7, 3.4), layout="constrained")
ax.plot(rest - dense.t, np.degrees(direction), label="direction of slip")
ax.plot(rest - sol.t[before], np.degrees(angles), "o", markersize=4, label="ends of steps")
ax.set_xscale("log")
ax.invert_xaxis()
ax.set_xlabel("time left to the landing")
ax.set_ylabel("direction of slip [degrees]")
ax.legend()
plt.show()

# %%
# **One step.**  The same oscillator far from its landing, written out in a few lines: the structure's answer to forces
# at the nodes is once exact (exponentials) and once that of plain Radau IIA.

K = np.diag([1.0, 2.3])
start, mu = np.array([2.0, 0.0, 0.6, 1.7]), 0.3


def nodes_of(s):
    """Radau IIA nodes, and the matrix that takes values at the nodes to monomials."""
    c = np.sort(legendre.legroots([*np.zeros(s - 1), -1.0, 1.0]).real)
    c = 0.5 * (c + 1.0)
    return c, np.linalg.inv(np.vander(c, increasing=True))


def exact_transfer(s, h):
    """Free motion at the nodes, and states there for unit forces at each node: (s, 4, 4) and (s, 4, s, 2)."""
    c, monomials = nodes_of(s)
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K, np.zeros((2, 2))]])
    free = np.array([expm(A * h * x) for x in c])
    answer = np.zeros((s, 4, s, 2))
    gauss, weight = legendre.leggauss(30)
    for i, x in enumerate(c):
        for u, w in zip(0.5 * x * (gauss + 1.0), 0.5 * x * weight, strict=True):
            basis = u ** np.arange(s) @ monomials
            answer[i] += h * w * expm(A * h * (x - u))[:, None, 2:] * basis[None, :, None]
    return free, answer


def radau_transfer(s, h):
    """The same by plain Radau IIA."""
    c, monomials = nodes_of(s)
    tableau = (c[:, None] ** np.arange(1, s + 1) / np.arange(1, s + 1)) @ monomials
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K, np.zeros((2, 2))]])
    solve = np.linalg.inv(np.eye(4 * s) - h * np.kron(tableau, A))
    free = (solve @ np.kron(np.ones((s, 1)), np.eye(4))).reshape(s, 4, 4)
    force = np.vstack([np.zeros((2, 2)), np.eye(2)])
    return free, (solve @ (h * np.kron(tableau, force))).reshape(s, 4, s, 2)


def step(transfer, s, h):
    """State after one step: Newton on one angle a node."""
    free, answer = transfer(s, h)
    y = free @ start
    angle = np.full(s, math.atan2(start[3], start[2]))
    for _ in range(20):
        n = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        t = np.stack([-n[:, 1], n[:, 0]], axis=1)
        g = (y - mu * np.einsum("iajb,jb->ia", answer, n))[:, 2:]
        jacobian = -mu * np.einsum("ia,iajb,jb->ij", t, answer[:, 2:], t) - np.diag(np.sum(n * g, axis=1))
        angle = angle - np.linalg.solve(jacobian, np.sum(t * g, axis=1))
    n = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return (y - mu * np.einsum("iajb,jb->ia", answer, n))[-1]


figure, ax = plt.subplots(figsize=(7, 4), layout="constrained")
lengths = np.geomspace(0.08, 0.6, 10)
slopes = {}
for s, color in ((2, "C0"), (3, "C1"), (4, "C2")):
    for transfer, line in ((exact_transfer, "-"), (radau_transfer, "--")):
        error = [np.abs(step(transfer, s, h) - step(exact_transfer, 9, h)).max() for h in lengths]
        slopes[s, line] = np.polyfit(np.log(lengths[:5]), np.log(error[:5]), 1)[0]
        kind = "exact structure" if line == "-" else "plain Radau IIA"
        ax.loglog(lengths, error, line, color=color, label=f"{kind}, s = {s} (slope {slopes[s, line]:.1f})")
ax.set_xlabel("step")
ax.set_ylabel("error of one step")
ax.legend(fontsize="small")
plt.show()

# %%
# **A run.**  The brake of the tutorial over 700 seconds and 213 transitions: error against the work done, with the
# structure exact and with plain Radau IIA throughout (``exact_up_to=0``).

brake = fm.models.brake4dof("2")
grid = np.linspace(0.0, 700.0, 1401)
true = fm.simulate(brake, t_end=700.0, rtol=1e-11, t_eval=grid, method="collocation")
size = np.abs(true.q).max(axis=1)
figure, ax = plt.subplots(figsize=(7, 3.6), layout="constrained")
errors = {}
for label, choice in (
    ("exact", Collocation(general=True)),
    ("plain Radau", Collocation(general=True, exact_up_to=0.0)),
):
    runs = [fm.simulate(brake, t_end=700.0, rtol=r, t_eval=grid, method=choice) for r in (1e-5, 1e-6, 1e-8)]
    error = [(np.abs(run.q - true.q).max(axis=1) / size).max() for run in runs]
    errors[label] = [float(x) for x in error]
    ax.loglog([run.stats.n_rhs for run in runs], error, "o-", label=f"{label} structure")
ax.set_xlabel("systems of port equations solved")
ax.set_ylabel("largest error of the run")
ax.legend()
plt.show()

# %%
# **Which is faster.**  Time of BDF or Radau, whichever is faster, over that of collocation of any ports, from the
# measurements in ``docs/benchmark/choice.json`` (``tools/choice_survey.py`` makes it): set-valued laws alone.

places = [Path(__file__).parent if "__file__" in globals() else Path.cwd(), Path.cwd()]
roots = [root for place in places for root in (place, *place.parents)]
survey = next(root / "docs/benchmark/choice.json" for root in roots if (root / "docs/benchmark/choice.json").exists())
measured = {(row["scene"], row["rtol"], row["method"]): row for row in json.loads(survey.read_text())}
figure, ax = plt.subplots(figsize=(7, 4), layout="constrained")
gains = {}
for rtol, color in ((1e-4, "C0"), (1e-6, "C1"), (1e-8, "C2"), (1e-10, "C3")):
    points = []
    for (scene_name, tolerance, which), row in measured.items():
        if tolerance != rtol or which != "collocation" or "ms" not in row or scene_name in ("belt, tanh", "belt, Dahl"):
            continue
        others = [measured[scene_name, rtol, other].get("ms", np.inf) for other in ("bdf", "radau")]
        points.append((row["rows"], min(others) / row["ms"]))
    count, gain = np.array(points).T
    gains[rtol] = gain[count <= 4]
    ax.loglog(count * 1.03 ** (np.log10(rtol) + 7), gain, "o", color=color, markersize=4, label=f"rtol = {rtol:.0e}")
ax.axhline(1.0, color="0.6", linewidth=0.8)
for axis, ticks in ((ax.xaxis, (1, 2, 4, 8, 16, 32)), (ax.yaxis, (0.3, 0.5, 1, 2, 3, 5))):
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_locator(NullLocator())
ax.set_xlabel("port rows")
ax.set_ylabel("time of BDF or Radau over collocation's")
ax.legend(fontsize="small")
plt.show()

# %%
# Numbers of what was shown.

print("order of one step:", {key: round(float(value), 1) for key, value in slopes.items()})
print("errors of the run:", errors)
assert all(slope > 2 * s - 0.5 for (s, _), slope in slopes.items())
assert errors["exact"][0] < 0.6 * errors["plain Radau"][0]
assert np.median(gains[1e-8]) > 1.0
