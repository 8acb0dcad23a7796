r"""
How hard must a table be shaken so that a box never sticks to it?
=================================================================

A box that always slides has a speed of straight lines of slope :math:`\pm\mu g`, with peaks of :math:`\mu g
\pi/(2\omega)`, where it meets the table. It does not stick there if the table accelerates harder at that instant:
:math:`\omega\sqrt{V^2 - (\mu g\pi/2\omega)^2} > \mu g`, or :math:`V\omega/(\mu g) > \sqrt{1 + \pi^2/4} = 1.862`.

Below the limit the box meets the table and sticks to it for a while; above it only passes the table's speed at an
instant.
"""

import math

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

mu_g, omega = 3.0, 10.0
critical = math.sqrt(1 + math.pi**2 / 4)
figure, axes = plt.subplots(1, 3, figsize=(8.0, 3.2), sharey=True, layout="constrained")
for ax, share in zip(axes, (0.7, 0.995, 1.005), strict=True):
    V = share * critical * mu_g / omega
    box, table = fm.Body("box", mass=1.0), fm.Driven("table", velocity={"x": V * sympy.sin(omega * fm.t)})
    sole = fm.Contact("sole", box, table, law=fm.laws.Coulomb(mu_s=1.0), normal_force=mu_g)
    sol = fm.simulate(fm.Scene("shaken", [box, table, sole]), t_end=20.0, rtol=1e-9)
    late = sol.at(np.linspace(18.7, 20.0, 800))
    ax.plot(late.t, late.velocity("box.x"), late.t, V * np.sin(omega * late.t), "--")
    sticks = sum(event.t > 18.0 for event in sol.events.of(kind="stick"))
    ax.set(xlabel="time (s)", title=f"{share:g} of the limit:\nsticks {sticks} times in 2 s")
    assert (sticks > 0) == (share < 1.0), share
axes[0].set_ylabel("speed of box and table (m/s)")
plt.show()
