r"""
Collocation of one contact's force
==================================

What the integrator of :doc:`/explanation/collocation` does, in three pictures: how the direction of slip settles before
a landing, what the error of one step depends on, and what an exact structure is worth over a whole run.
"""

import math

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter
from numpy.polynomial import legendre
from scipy.linalg import expm

import fricmb as fm
from fricmb.integrate import integrators

# %%
# **Landing.**  A mass on two springs slides to rest.  Seen over the time that is left, the direction of slip settles
# like a broken power: no polynomial follows that at any fixed step, so steps shorten with the time that is left, and a
# last short rest is crossed in one.

scene = fm.models.planar_oscillator(friction=0.3, position=(2.0, 0.0), velocity=(0.0, 1.7))
sol = fm.simulate(scene, t_end=20.0, rtol=1e-12, method="collocation")
rest = sol.events.of(kind="stick").t[-1]
left = np.geomspace(3.0, 1e-6, 400)
dense = fm.simulate(scene, t_end=20.0, rtol=1e-12, t_eval=np.sort(rest - left), method="collocation")
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
# **A run.**  The brake of the tutorial over 700 seconds and 213 transitions, with seven nodes a step: error against the
# systems that Newton's method solves.  Those of ``collocation`` have one unknown a node, an angle; those of ``radau``
# the velocities of all bodies as well; and sticking, which is a closed form, takes ``collocation`` no system at all.

brake = fm.models.brake4dof("2")
grid = np.linspace(0.0, 700.0, 1401)
true = fm.simulate(brake, t_end=700.0, rtol=1e-11, t_eval=grid, method="radau")
size = np.abs(true.q).max(axis=1)
figure, ax = plt.subplots(figsize=(7, 3.6), layout="constrained")
errors, systems = {}, {}
# the counter of radau counts stages, of which a system has seven
for method, per in ((integrators["collocation"](nodes=7), 1), (integrators["radau"](stages=7), 7)):
    runs = [fm.simulate(brake, t_end=700.0, rtol=r, t_eval=grid, method=method) for r in (1e-5, 1e-6, 1e-7, 1e-8)]
    errors[method.name] = [float((np.abs(run.q - true.q).max(axis=1) / size).max()) for run in runs]
    systems[method.name] = [run.stats.n_rhs // per for run in runs]
    ax.loglog(systems[method.name], errors[method.name], "o-", label=method.name)
ax.xaxis.set_major_locator(FixedLocator([2000, 3000, 5000, 10000]))
ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
ax.xaxis.set_minor_formatter(NullFormatter())
ax.set_xlabel("systems solved")
ax.set_ylabel("largest error of the run")
ax.legend()
plt.show()

# %%
# Numbers of what was shown.

print("order of one step:", {key: round(float(value), 1) for key, value in slopes.items()})
print("errors of the run:", errors)
print("systems solved:", systems)
assert all(slope > 2 * s - 0.5 for (s, _), slope in slopes.items())
assert all(a < b for a, b in zip(*errors.values(), strict=True))
assert all(a < 0.6 * b for a, b in zip(*systems.values(), strict=True))
