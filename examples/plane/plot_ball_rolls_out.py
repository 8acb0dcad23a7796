r"""
Which stops first, the roll of a ball or its spin?
==================================================

A ball rolls and spins on cloth, which holds it back with torques of an arm times its weight: f against rolling, s
against spinning. It loses speed at :math:`\frac57 f g/r`, and spin at :math:`\frac52 s g/r^2`; both are set-valued, so
it comes to rest and stays there.

The speed of the ball, and of its rim about the vertical, with the times of both formulas as lines.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

r, g, v, spin, f, s = 0.03, 9.81, 0.5, 20.0, 0.0006, 0.0009
ball = fm.space.Ball(
    "ball", mass=0.17, radius=r, position=(0, 0, r), velocity=(v, 0, 0), angular_velocity=(0, v / r, spin)
)
cloth = fm.space.OnPlane(
    "cloth", ball, normal=(0, 0, 1), friction=fm.laws.Coulomb(mu_s=0.2), rolling_resistance=f, spinning_resistance=s
)
scene = fm.Scene("ball", [ball, cloth, fm.Gravity("g", acceleration={"z": -g})])
sol = fm.simulate(scene, t_end=4.5, rtol=1e-9, t_eval=np.linspace(0, 4.5, 300))
stops = v / (5 / 7 * f * g / r), spin / (5 / 2 * s * g / r**2)

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(sol.t, sol.velocity("ball.x"), label="speed")
ax.plot(sol.t, r * sol.relative_velocity("cloth_spinning")[0], label="rim, about the vertical")
for stop in stops:
    ax.axvline(stop, color="k", lw=0.6, ls="--")
ax.set(xlabel="time (s)", ylabel="speed (m/s)")
ax.legend()
plt.show()

found = [float(next(e.t for e in sol.events if e.contact == f"cloth_{kind}")) for kind in ("rolling", "spinning")]
print(f"rolls for {found[0]:.9f} s, spins for {found[1]:.9f} s; closed forms {stops[0]:.9f}, {stops[1]:.9f}")
assert np.allclose(found, stops, rtol=1e-8)
