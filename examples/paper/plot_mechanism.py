r"""
The mechanism: an impulse in every valley
=========================================

The source explains the kicks across by the slip along x becoming slow once in each swing of the pad: then the direction
of friction turns. It could not show what each valley of the slip transfers. Here is that, before and after the first
stick, and what it depends on.

Across, while the slip along x, :math:`v`, is much the larger, the friction force is
:math:`-\mu N (\dot y_1 - \dot y_2)/v`: a dashpot whose constant is :math:`\mu N/v`. The pad's swing along x is
proportional to the load, and so is :math:`v` if it starts so: **the load cancels**. What counts is the depth of the
valley, its least slip over the load, and the speed of the rotor across that the dashpot passes on.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import valleys

# %%
# A rotor a little faster than the pad's swing, so that it slips for six swings before the first stick; three loads, two
# mass ratios.

runs = {}
for load in (3.0, 5.0, 10.0):
    for mass_ratio in (100.0, 1000.0):
        speed = load * (1 + 2 * np.pi * 6.5 / mass_ratio)
        scene = fm.models.brake4dof("2", mu_k_N=load, mass_ratio=mass_ratio, u0=speed)
        runs[load, mass_ratio] = fm.simulate(scene, t_end=100.0, rtol=1e-8)
kicks = {key: valleys(sol) for key, sol in runs.items()}
passed_on = {key: k.impulse / runs[key].at(k.begin).velocity("rotor.y") for key, k in kicks.items()}

# %%
# Impulses, swing by swing; filled where the lining sticks. They grow as the valleys deepen, and are there before the
# first stick.

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
markers = {3.0: "o", 5.0: "s", 10.0: "^"}
colours = {100.0: "#006BA4", 1000.0: "#C85200"}
for (load, mass_ratio), k in kicks.items():
    for sticks in (False, True):
        part = k.sticks == sticks
        left.plot(
            k.begin[part],
            k.impulse[part],
            markers[load],
            color=colours[mass_ratio],
            markersize=4,
            markerfacecolor=colours[mass_ratio] if sticks else "none",
            label=f"load {load:g}, mass ratio {mass_ratio:g}" if sticks else None,
        )
    part = ~k.sticks
    right.loglog(
        k.least[part] / load,
        passed_on[load, mass_ratio][part],
        markers[load],
        color=colours[mass_ratio],
        markersize=4,
        markerfacecolor="none",
    )
left.set_xlabel("time")
left.set_ylabel("impulse across in each valley")
figure.legend(loc="outside upper center", ncols=3, fontsize="small", frameon=False)
right.set_xlabel("least slip over load")
right.set_ylabel("impulse over the rotor's speed across")
for ax in (left, right):
    ax.grid(True, linewidth=0.4, alpha=0.5)
plt.show()

# %%
# The load: none. Valley by valley, before the first stick, three loads bring the same impulse, to half a percent where
# the valley is not so deep that the motion across counts in the slip.

for mass_ratio in (100.0, 1000.0):
    before = ~kicks[10.0, mass_ratio].sticks & (kicks[10.0, mass_ratio].least > 0.05 * 10.0)
    spread = (
        np.ptp([passed_on[load, mass_ratio][before] for load in markers], axis=0) / passed_on[10.0, mass_ratio][before]
    )
    if before.any():
        print(f"mass ratio {mass_ratio:g}: {before.sum()} valleys, impulses of three loads within {spread.max():.1e}")
        assert spread.max() < 5e-3

# %%
# The mass ratio sets how fast the valleys deepen, by 2 pi over it in units of the load, and so how many strong kicks
# come before the first stick; and how fast the rotor's own motion across is used up. At the same depth the impulse is
# the same.

deep = {
    mass_ratio: np.interp(
        np.log(0.015),
        np.log(kicks[10.0, mass_ratio].least[5::-1] / 10.0),
        passed_on[10.0, mass_ratio][5::-1],
    )
    for mass_ratio in (100.0, 1000.0)
}
print(f"at a depth of 0.015: {deep[100.0]:.2f} and {deep[1000.0]:.2f} times the rotor's speed across")
assert abs(deep[1000.0] / deep[100.0] - 1) < 0.06

# %%
# After the first stick the impulse is no longer set by a depth but by how long the lining sticks. With the heavy rotor
# that hardly changes, and each valley passes on 38 to 39.5 times the rotor's speed.

k, ratio = kicks[10.0, 1000.0], passed_on[10.0, 1000.0]
settled = k.sticks & (k.begin > 50.0) & (k.begin < 85.0)
print(np.round(ratio[settled], 2))
assert settled.sum() >= 5
assert (np.abs(ratio[settled] - 38.8) < 0.7).all()
