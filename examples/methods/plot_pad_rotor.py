"""
How many modes, how many contacts
=================================

A pad presses on a slowing rotor until it stands; both are elastic in their plane, given by modes of finite element
models (:func:`fricmb.models.pad_rotor`, SI units).  How many modes must be kept, and on how many points must the pad be
supported, for the time to stop, for the transitions between stick and slip, and for the spectrum of the train of
impulses that they give the pad?  What stops is the rotation of the rotor, ``rotor.mode1``.
"""

import time

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

t_end, speed, mu_s, mu_k, load = 12e-3, 0.2, 0.5, 0.4, 2000.0
t = np.arange(0.0, t_end, 2e-6)
sliding = t < 6.5e-3  # the last stop is left to other measures


def brake(pad_modes, rotor_modes, contacts):
    """One braking, and what is read from it."""
    scene = fm.models.pad_rotor(pad_modes, rotor_modes, contacts, speed=speed, normal_force=load, mu_s=mu_s, mu_k=mu_k)
    began = time.perf_counter()
    sol = fm.simulate(scene, t_end=t_end, rtol=1e-6, t_eval=t)
    wall = time.perf_counter() - began - sol.stats.compile_s
    stop = t[np.flatnonzero(sol.velocity("rotor.mode1") <= 0.0)[0]]
    force = sum(sol.force(name)[0] for name in sol.contact_names)
    window = np.hanning(sliding.sum())
    shaken = (force[sliding] - force[sliding].mean()) * window
    density = 2.0 * 2e-6 * np.abs(np.fft.rfft(shaken)) ** 2 / np.sum(window**2)
    f = np.fft.rfftfreq(shaken.size, 2e-6)
    bands = [(500.0, 5e3), (5e3, 20e3), (20e3, 60e3)]
    levels = [np.sqrt(np.sum(density[(f >= a) & (f < b)]) * f[1]) for a, b in bands]
    sticks = np.any([sol.mode(name) == 0 for name in sol.contact_names], axis=0)
    before = sum(event.t < stop for event in sol.events)
    return {
        "scene": scene, "sol": sol, "stop": stop, "before": before, "after": len(sol.events) - before,
        "stuck": np.mean(sticks[t < stop]), "levels": levels, "f": f, "density": density, "wall": wall,
    }  # fmt: skip


# %%
# First the modes, for one contact and for a grid of four; then the contacts, at a fixed number of modes.

numbers = [(3, 0, 1), (3, 4, 1), (6, 8, 1), (12, 16, 1), (24, 32, 1)]
numbers += [(3, 4, 4), (6, 8, 4), (12, 16, 4), (24, 32, 4), (40, 40, 4)]
numbers += [(12, 16, 2), (12, 16, 6)]
runs = {case: brake(*case) for case in numbers}

print("modes of pad, rotor | contacts | stops at | transitions | a point sticks | friction force, rms (N) in kHz")
print("                    |          |   (ms)   | until, after |  (until then) |  0.5-5    5-20    20-60 | run (s)")
for (pad, rotor, contacts), run in runs.items():
    low, middle, high = run["levels"]
    print(
        f"{pad:8d} + {rotor:<9d} | {contacts:8d} | {1e3 * run['stop']:8.3f} | {run['before']:5d} {run['after']:6d} |"
        f" {run['stuck']:14.1%} | {low:7.2f} {middle:7.2f} {high:7.2f} | {run['wall']:6.2f}"
    )

# %%
# **The time to stop** needs neither modes nor contacts: a rigid pad that slides gives :math:`v J/(\mu_k N r^2)`, with
# the inertia of the rotor's rotation.  Sticking makes it longer, since a point that is carried along brakes with less
# than :math:`\mu_k N`.

rigid = {}
for case, run in runs.items():
    shapes = run["scene"]["rotor"].shapes
    pull = sum(c.normal_force * shapes[f"p{i + 1}"][0, 0] for i, c in enumerate(run["scene"].contacts))
    rigid[case] = run["sol"].velocity("rotor.mode1")[0] / (mu_k * pull)
    print(f"{case}: {1e3 * run['stop']:.3f} ms, rigid and sliding {1e3 * rigid[case]:.3f} ms")

# %%
# **What the pad does until then**

figure, axes = plt.subplots(2, 1, figsize=(7, 6), sharex=True, sharey=True, layout="constrained")
for ax, contacts in zip(axes, (1, 4), strict=True):
    for (pad, rotor, n), run in runs.items():
        if n == contacts and (pad, rotor) in ((3, 4), (12, 16), (24, 32)):
            ax.plot(1e3 * t, 1e3 * run["sol"].velocity("pad.p1.x"), lw=0.9, label=f"{pad} + {rotor} modes")
    ax.set(ylabel="pad at its first point,\nalong the rotor (mm/s)", title=f"{contacts} contact{'s' * (contacts > 1)}")
    ax.axvline(1e3 * runs[12, 16, contacts]["stop"], color="0.5", lw=0.8, ls="--")
axes[0].legend(loc="upper right", fontsize="small")
axes[1].set(xlabel="t (ms); dashed: the rotor stands for the first time", xlim=(0, 1e3 * t_end))
plt.show()

# %%
# **The train of impulses**: density of the friction force on the pad while it slides and sticks, before the stop.

figure, axes = plt.subplots(2, 1, figsize=(7, 6), sharex=True, sharey=True, layout="constrained")
smooth = np.ones(5) / 5
for ax, contacts in zip(axes, (1, 4), strict=True):
    for (pad, rotor, n), run in runs.items():
        if n == contacts and (pad, rotor) in ((3, 4), (12, 16), (24, 32)):
            level = np.sqrt(np.convolve(run["density"], smooth, "same"))
            ax.semilogy(run["f"] / 1e3, level, lw=0.9, label=f"{pad} + {rotor} modes")
    ax.set(ylabel=r"friction force (N/$\sqrt{\mathrm{Hz}}$)", title=f"{contacts} contact{'s' * (contacts > 1)}")
axes[0].legend(loc="upper right", fontsize="small")
axes[1].set(xlabel="frequency (kHz)", xlim=(0, 60), ylim=(1e-5, 1e1))
plt.show()

# %%
# What a brake engineer can take from it:
#
# - *Stopping time.*  The rigid formula is right to 1.1 %, whatever is left out; modes change it by 0.5 %, contacts by
#   1.5 %.  Nobody needs elastic bodies for it.
# - *One point of support is another brake.*  The rotor carries it along at every swing on the mounting (2.2 kHz): it
#   sticks for a quarter of the time, with 25 to 30 transitions and some 40 N of impulses around 10 kHz, whose spectrum
#   has its lines at multiples of the swing.  Two points and more slide until the last half millisecond, and
#   all that is left are some 0.5 N: a factor of 60.  From two contacts on their number changes these levels by 10 %.
#   Choose contacts before modes.
# - *Impulses of one point do not converge with modes* in this run: each truncation has transitions of its own, and its
#   levels differ by a quarter.  They are statistics of a stick-slip motion; average them over several starts.
# - *With four points levels converge*: below 5 kHz with 3 + 4 modes (pad up to 2.8 kHz, rotor up to 11 kHz), from 5 to
#   20 kHz to 3 % with 6 + 8 (23 and 16 kHz), above 20 kHz to 4 % with 24 + 32 (71 and 28 kHz); with half of these the
#   level there is half.  Keep the modes of both bodies up to the end of the band that is asked for.
# - *Many contacts on few modes chatter.*  Four points hold eight motions; 3 + 4 modes and the rotation have only eight
#   altogether.  Such a pad creaks after the stop a hundred times; with 12 + 16 modes a dozen times.  Keep at
#   least three modes for each direction of each contact, or count transitions with caution.  (The plan names contacts
#   that are redundant altogether.)

for case, run in runs.items():
    assert abs(run["stop"] / rigid[case] - 1.0) < 0.012, case
    assert np.abs(run["sol"].energy.residual).max() < 1e-6, case
one, four, finest = runs[12, 16, 1], runs[12, 16, 4], runs[40, 40, 4]
assert one["levels"][1] > 50.0 * four["levels"][1]
assert one["stuck"] > 4.0 * four["stuck"]
np.testing.assert_allclose(runs[3, 4, 4]["levels"][0], finest["levels"][0], rtol=0.02)
np.testing.assert_allclose(runs[6, 8, 4]["levels"][1], finest["levels"][1], rtol=0.06)
np.testing.assert_allclose(runs[24, 32, 4]["levels"], finest["levels"], rtol=0.1)
np.testing.assert_allclose(four["levels"][:2], runs[12, 16, 2]["levels"][:2], rtol=0.15)
assert runs[6, 8, 4]["after"] > 5 * runs[24, 32, 4]["after"]
