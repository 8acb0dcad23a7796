r"""
How much of a conveyor's work becomes heat?
===========================================

Half of it: a box laid on a belt of speed V needs friction for :math:`V/(\mu g)`, in which the belt pulls with
:math:`\mu m g` over twice the distance that the box travels. The belt gives :math:`m V^2`, the box has :math:`m
V^2/2` in the end.

The two areas are the kinetic energy of the box and the heat; together they fill the dashed line, the work of the
belt.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

m, mu, g, V = 5.0, 0.4, 9.81, 1.5
box, belt = fm.Body("box", mass=m), fm.Driven("belt", velocity={"x": V})
contact = fm.Contact("base", box, belt, law=fm.laws.Coulomb(mu_s=mu), normal_force=m * g)
sol = fm.simulate(fm.Scene("conveyor", [box, belt, contact]), t_end=0.6, rtol=1e-10, t_eval=np.linspace(0.0, 0.6, 301))

energy = sol.energy
figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.stackplot(sol.t, energy.kinetic, energy.friction_loss, labels=["kinetic", "heat"], alpha=0.7)
ax.plot(sol.t, energy.input, "k--", label="work of the belt")
ax.set(xlabel="time (s)", ylabel="energy (J)")
ax.legend(loc="lower right")
plt.show()

caught = sol.events[0].t
print(f"caught at {caught:.9f} s, closed form {V / (mu * g):.9f} s; heat {energy.friction_loss[-1]:.9f} J")
assert abs(caught / (V / (mu * g)) - 1) < 1e-9
assert abs(energy.friction_loss[-1] / (0.5 * m * V**2) - 1) < 1e-9
assert abs(energy.input[-1] / (m * V**2) - 1) < 1e-9
