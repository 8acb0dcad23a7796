"""
The brake, case 2
=================

A pad on springs against a slowing rotor; see :doc:`/explanation/paper` for the source.  Along the braking direction the
pad is dragged, sticks and is torn off again; each time the slip is slow, the friction force swings sideways and shakes
the pad *across* the braking direction.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

scene = fm.models.brake4dof("2")
sol = fm.simulate(scene, t_end=700.0, rtol=1e-8)
print(sol.summary())

# %%
# Velocities along x and across, y.

fm.plot.show(sol.plot.velocities())

# %%
# When the lining sticks, and for how long: it ends sticking for good when the rotor has stopped.

fm.plot.show(sol.plot.transitions())

# %%
# The friction force has the length of the cone while slipping; while sticking it is inside.

fm.plot.show(sol.plot.force("lining"))

# %%
# The spectrum of the pad's motion across: peaks one apart (the pad's frequency along x is 1), none at its own frequency
# of 12.53.

dt = 0.05
fine = sol.at(np.arange(14000) * dt)
omega, power = fm.analysis.maximum_entropy_spectrum(fine["pad.y"], dt, omega=np.linspace(0.0, 20.0, 4001))
figure, ax = plt.subplots(figsize=(7, 3.2), layout="constrained")
ax.semilogy(omega, power, linewidth=0.8)
ax.set_xlabel("angular frequency")
ax.set_ylabel("power density of pad.y")
ax.grid(True, linewidth=0.4, alpha=0.5)
plt.show()

# %%
# The certified reference has 213 transitions, the first at 0.728764012250806.

print(len(sol.events), sol.events[0].t)
assert len(sol.events) == 213
assert abs(sol.events[0].t - 0.728764012250806) < 1e-7
