r"""
Den Hartog's driven oscillator
==============================

A mass on a spring rubs on the ground and is driven by :math:`\cos\beta t`.  Where it never sticks, J. P. Den Hartog
(1931) gave its amplitude in closed form: with :math:`V = 1/(1-\beta^2)`,
:math:`U = \sin(\pi/\beta)/(\beta(1+\cos(\pi/\beta)))` and the friction force :math:`f` it is
:math:`\sqrt{V^2 - f^2 U^2}`.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm


def closed_form(beta, f):
    """Amplitude over that of the static deflection."""
    V = 1 / (1 - beta**2)
    U = math.sin(math.pi / beta) / (beta * (1 + math.cos(math.pi / beta)))
    return math.sqrt(V**2 - f**2 * U**2)


# %%
# The oscillation settles slowly, so run long and look at the last periods.

beta, f = 0.7, 0.2
scene = fm.models.friction_oscillator(friction=f, amplitude=1.0, frequency=beta)
sol = fm.simulate(scene, t_end=500.0, rtol=1e-9)
last = sol.at(np.linspace(400.0, 500.0, 20001))
amplitude = np.abs(last["mass.x"]).max()

figure, ax = plt.subplots(figsize=(5, 4.5), layout="constrained")
sol.plot.phase("mass.x", ax=ax)
ax.plot(last["mass.x"], last.velocity("mass.x"), color="tab:orange", label="settled")
ax.legend()
plt.show()

# %%

print(f"amplitude {amplitude:.9f}, closed form {closed_form(beta, f):.9f}")
assert abs(amplitude / closed_form(beta, f) - 1) < 1e-6
