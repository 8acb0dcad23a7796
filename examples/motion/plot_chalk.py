r"""
Why does chalk screech when it is pushed?
=========================================

A rod slides on its tip at the angle a. Drawn, friction lifts it; pushed, friction digs it in. For a uniform rod at rest
in turning, :math:`N/(mg) = 1/(1 + 3\cos^2 a \pm 3\mu \sin a\cos a)` (P. Painleve, 1895; F. Genot and B. Brogliato, Eur.
J. Mech. A 18 (1999) 653): pushed with :math:`\mu` near 4/3 it has no bound at :math:`\tan a = 2`.

Lines are the formula, dots are fricmb. Drawn, the tip bears less than the weight. Pushed, it bears up to six times
the weight, at the angle at which the chalk screeches.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

mu = 1.2
angles = np.linspace(0.15, 1.5, 28)
figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
for speed, name in ((3.0, "drawn"), (-3.0, "pushed")):
    found = []
    for angle in angles:
        scene = fm.models.painleve_rod(mu=mu, angle=angle, speed=speed)
        found.append(fm.simulate(scene, t_end=1e-4).normal_force("tip")[0] / 9.81)
    s = np.sign(speed)
    closed = 1 / (1 + 3 * np.cos(angles) ** 2 + 3 * mu * s * np.sin(angles) * np.cos(angles))
    ax.plot(np.degrees(angles), closed, label=name)
    ax.plot(np.degrees(angles), found, ".", color="k", markersize=3)
    print(name, np.abs(found / closed - 1).max())
    assert np.abs(found / closed - 1).max() < 1e-6
ax.set(xlabel="angle from the board (degrees)", ylabel="normal force / weight")
ax.legend()
plt.show()
