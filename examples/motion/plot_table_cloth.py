r"""
Can you pull a cloth from under a glass?
========================================

Under the glass the cloth slides for the time :math:`\tau` with :math:`V\tau - \mu_1 g\tau^2/2 = L`. The glass has then
moved by :math:`s_1 = \mu_1 g \tau^2/2` and slides on the table as far as its speed :math:`\mu_1 g\tau` carries it:
:math:`s_1 \mu_1/\mu_2`.

The glass speeds up while the cloth is under it, and slows down on the table along a second parabola.
"""

import math

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import fricmb as fm

cloth_mu, table_mu, g, V, L = 0.25, 0.4, 9.81, 2.5, 0.3
glass, cloth = fm.Body("glass", mass=0.3), fm.Driven("cloth", velocity={"x": V})
foot = fm.Contact("foot", glass, cloth, law=fm.laws.Coulomb(mu_s=cloth_mu), normal_force=0.3 * g)
first = fm.simulate(fm.Scene("on the cloth", [glass, cloth, foot]), t_end=0.3, rtol=1e-10)
off = brentq(lambda t: first.at([t])["cloth.x"][0] - first.at([t])["glass.x"][0] - L, 0.0, 0.3, xtol=1e-15)
at = first.at(np.linspace(0.0, off, 50))
table = fm.Contact("foot", glass, law=fm.laws.Coulomb(mu_s=table_mu), normal_force=0.3 * g)
start = {"position": {"glass.x": at["glass.x"][-1]}, "velocity": {"glass.x": at.velocity("glass.x")[-1]}}
second = fm.simulate(fm.Scene("on the table", [glass, table]), t_start=off, t_end=0.4, initial=start)

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(at.t, 100 * at["glass.x"], label="on the cloth")
fine = second.at(np.linspace(off, 0.4, 100))
ax.plot(fine.t, 100 * fine["glass.x"], label="on the table")
ax.set(xlabel="time (s)", ylabel="displacement of the glass (cm)")
ax.legend()
plt.show()

tau = (V - math.sqrt(V**2 - 2 * cloth_mu * g * L)) / (cloth_mu * g)
closed = 0.5 * cloth_mu * g * tau**2 * (1 + cloth_mu / table_mu)
print(f"the glass ends {100 * second['glass.x'][-1]:.9f} cm away, closed form {100 * closed:.9f} cm")
assert abs(second["glass.x"][-1] / closed - 1) < 1e-8
