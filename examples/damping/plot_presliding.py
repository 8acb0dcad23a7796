r"""
How far does a contact give way before it slips?
================================================

A bristle of stiffness :math:`\sigma` that is torn off gradually (P. R. Dahl, AIAA Journal 14 (1976) 1675-1682) has
the force :math:`\mu N (1 - e^{-\sigma x/\mu})` after the displacement x: 95 % of slip after :math:`\mu \ln
20/\sigma`, at any speed.

The black line is the first pull from rest. The loops are cycles of small amplitude, which lose energy before
anything slips.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

mu, sigma = 0.3, 1e4
law = fm.laws.Dahl(sigma0=sigma, mu=mu)
pull = fm.analysis.path(law, lambda t: np.full_like(t, 1e-3), np.linspace(0.0, 0.3, 3001))
loops = [fm.analysis.cycle(law, amplitude=a, period=1.0) for a in (1e-5, 3e-5, 1e-4)]

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
first = pull.displacement < 1.2e-4
ax.plot(1e6 * pull.displacement[first], -pull.force[first], "k", label="first pull")
for loop in loops:
    ax.plot(1e6 * loop.displacement, -loop.force, linewidth=1.0)
ax.set(xlabel="displacement (micrometres)", ylabel="friction / normal force")
ax.legend(loc="upper left")
plt.show()

way = np.interp(0.95 * mu, -pull.force, pull.displacement)
print(f"95 % after {1e6 * way:.4f} micrometres, closed form {1e6 * mu * np.log(20) / sigma:.4f}")
assert abs(way / (mu * np.log(20) / sigma) - 1) < 1e-5
assert np.abs(-pull.force - mu * (1 - np.exp(-sigma * pull.displacement / mu))).max() < 1e-6
