r"""
How large do vibrations get where something rubs?
=================================================

A driven mass that rubs with the force f (of the drive's amplitude) and never sticks swings by :math:`\sqrt{V^2 - f^2
U^2}` times the static deflection, with :math:`V = 1/(1-\beta^2)` and :math:`U =
\sin(\pi/\beta)/(\beta(1+\cos(\pi/\beta)))` at :math:`\beta` times its frequency: J. P. Den Hartog, Forced vibrations
with combined Coulomb and viscous friction, Trans. ASME 53 (1931) 107-115.

The picture shows the motion from rest in the phase plane; the settled cycle, in orange, reaches the amplitude of
the formula.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

beta, f = 0.7, 0.2
scene = fm.models.friction_oscillator(friction=f, amplitude=1.0, frequency=beta)
sol = fm.simulate(scene, t_end=500.0, rtol=1e-9)
last = sol.at(np.linspace(400.0, 500.0, 20001))
amplitude = np.abs(last["mass.x"]).max()

figure, ax = plt.subplots(figsize=(5, 4.2), layout="constrained")
sol.plot.phase("mass.x", ax=ax)
ax.plot(last["mass.x"], last.velocity("mass.x"), color="tab:orange", label="settled")
ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize="small", borderaxespad=0.2)
plt.show()

V = 1 / (1 - beta**2)
U = math.sin(math.pi / beta) / (beta * (1 + math.cos(math.pi / beta)))
closed = math.sqrt(V**2 - f**2 * U**2)
print(f"amplitude {amplitude:.9f}, closed form {closed:.9f}")
assert abs(amplitude / closed - 1) < 1e-6
