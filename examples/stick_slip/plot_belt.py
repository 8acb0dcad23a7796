r"""
What is the period of stick-slip?
=================================

A mass on a belt rides along until its spring tears it off, :math:`D = (\mu_s - \mu_k)N/k` beyond where slip is in
balance. It swings about that with :math:`\omega = \sqrt{k/m}` until it is as fast as the belt, D on the other side, and
rides for :math:`2D/v`: :math:`T = 2(\pi - \arctan(D\omega/v))/\omega + 2D/v`.

Above, the velocity of the mass: level while it rides on the belt. Below, the friction force: it follows the spring
up to break-away and falls back.
"""

import math

import matplotlib.pyplot as plt

import fricmb as fm

D, v = 0.5, 0.2
scene = fm.models.belt_oscillator(mu_s=1.0, mu_k=0.5, belt=v)
sol = fm.simulate(scene, t_end=40.0, rtol=1e-10)

figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.4, 4.4), sharex=True, layout="constrained")
sol.plot.velocities(["mass.x"], ax=top)
sol.plot.force("sole", ax=bottom)
plt.show()

period = 2 * (math.pi - math.atan(D / v)) + 2 * D / v
sticks = sol.events.of(kind="stick").t
measured = (sticks[-1] - sticks[0]) / (len(sticks) - 1)
print(f"period {measured:.12f}, closed form {period:.12f}")
assert abs(measured / period - 1) < 1e-8
