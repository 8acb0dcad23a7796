"""
Mass on a moving belt
=====================

The textbook of stick-slip: a mass on a belt, held by a spring, with a break-away coefficient above the coefficient of
slip.  It rides along until the spring tears it off, swings back, and is caught again.
"""

# %%
# The model is built in; ``fm.models.belt_oscillator`` shows how little it takes.

import math

import matplotlib.pyplot as plt

import fricmb as fm

scene = fm.models.belt_oscillator(mu_s=1.0, mu_k=0.5, belt=0.2)
sol = fm.simulate(scene, t_end=60.0, rtol=1e-10)
print(sol.summary())

# %%
# Sticking is sticking: the velocity of the mass *is* that of the belt.

figure, (top, bottom) = plt.subplots(2, 1, figsize=(7, 6), layout="constrained")
sol.plot.velocities(["mass.x"], ax=top)
sol.plot.force("sole", ax=bottom)
plt.show()

# %%
# The period has a closed form: with :math:`D = (\mu_s - \mu_k) N/k` and :math:`\omega = \sqrt{k/m}`,
# :math:`T = 2 (\pi - \arctan(D\omega/v))/\omega + 2 D/v`.

D, v = 0.5, 0.2
period = 2 * (math.pi - math.atan(D / v)) + 2 * D / v
sticks = sol.events.of(kind="stick").t
measured = (sticks[-1] - sticks[0]) / (len(sticks) - 1)
print(f"period {measured:.12f}, closed form {period:.12f}")
assert abs(measured / period - 1) < 1e-8
