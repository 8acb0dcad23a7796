r"""
How much dry friction tames a resonance?
========================================

At its own frequency a force :math:`P\cos\omega t` does the work :math:`\pi P a` in a period, friction takes :math:`4 F
a`: both grow with the amplitude a alike. Below :math:`F = \pi P/4` nothing stops the growth, by :math:`(\pi P - 4F)/k`
a period (J. P. Den Hartog, Trans. ASME 53 (1931) 107-115).

Below the critical friction the swings grow for ever, more slowly the nearer friction is to it. Above it they stay
bounded.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
for share in (0.4, 0.8, 1.05):
    F = share * math.pi / 4
    scene = fm.models.friction_oscillator(friction=F, amplitude=1.0, frequency=1.0)
    sol = fm.simulate(scene, t_end=400.0, rtol=1e-8, t_eval=np.linspace(0.0, 400.0, 8001))
    ax.plot(sol.t / (2 * math.pi), sol["mass.x"], linewidth=0.6, label=f"F = {share:g} $\\pi P/4$")
    peaks = [np.abs(sol["mass.x"][(sol.t > a) & (sol.t < a + 2 * math.pi)]).max() for a in (150.0, 390.0 - 2 * math.pi)]
    growth = (peaks[1] - peaks[0]) / (240.0 / (2 * math.pi) - 1)
    print(f"F = {F:.4f} P: grows by {growth:.5f} P/k a period, closed form {max(math.pi - 4 * F, 0.0):.5f}")
    assert abs(growth - max(math.pi - 4 * F, 0.0)) < 0.02
ax.set(xlabel="periods", ylabel="displacement k/P")
ax.legend(loc="upper left")
plt.show()
