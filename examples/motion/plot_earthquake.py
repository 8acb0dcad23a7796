r"""
How far does a building on sliding bearings slip in an earthquake?
==================================================================

For a pulse of ground acceleration :math:`a`, that leaves the ground at speed :math:`V`, N. M. Newmark (Effects of
earthquakes on dams and embankments, Geotechnique 15 (1965) 139-160) gives :math:`\frac{V^2}{2\mu g}(1 - \mu g/a)`: the
building is brought to V by :math:`\mu g` alone, the ground by :math:`a`; the slip is the area between two straight
lines.

The house follows the ground along a straight line that friction alone determines. The shaded area between the two
speeds is the slip.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

mu, g, a, V = 0.06, 9.81, 4.0, 0.8
house = fm.Body("house", mass=1.0)
ground = fm.Driven("ground", velocity={"x": sympy.Piecewise((a * fm.t, fm.t < V / a), (V, True))})
bearing = fm.Contact("bearing", house, ground, law=fm.laws.Coulomb(mu_s=mu), normal_force=g)
scene = fm.Scene("isolation", [house, ground, bearing])
sol = fm.simulate(scene, t_end=2.0, rtol=1e-10, t_eval=np.linspace(0.0, 2.0, 401))

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
speed = sol.velocity("house.x")
ax.plot(sol.t, speed, label="house")
ax.plot(sol.t, speed - sol.relative_velocity("bearing")[0], "--", label="ground")
ax.fill_between(sol.t, speed, speed - sol.relative_velocity("bearing")[0], alpha=0.2)
ax.set(xlabel="time (s)", ylabel="speed (m/s)", title="the area is the slip")
ax.legend()
plt.show()

slip = sol["ground.x"][-1] - sol["house.x"][-1]
closed = V**2 / (2 * mu * g) * (1 - mu * g / a)
print(f"slip {slip:.12f} m, Newmark {closed:.12f} m")
assert abs(slip / closed - 1) < 1e-9
