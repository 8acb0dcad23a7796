r"""
Can shaking carry a box along?
==============================

Yes, if it is shaken slowly one way and quickly back: on a table that gains the speed V at :math:`a_1 < \mu g` and
loses it at :math:`a_2 > \mu g`, the box slides on. The speeds meet again after :math:`\tau = V (1 + a_1/a_2)/(a_1 +
\mu g)`; the area between them until then is the distance that the box gains in a period.

Above, the box follows the table while it speeds up, and slides on when the table stops. Below, each period adds the
same distance.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

mu_g, a1, a2, V = 3.0, 2.0, 20.0, 0.4
rise, fall, n = V / a1, V / a2, 5
speed = []
for s in np.arange(n) * (rise + fall):
    speed += [(a1 * (fm.t - s), fm.t < s + rise), (V - a2 * (fm.t - s - rise), fm.t < s + rise + fall)]
table = fm.Driven("table", velocity={"x": sympy.Piecewise(*speed, (0, True))})
box = fm.Body("box", mass=1.0)
sole = fm.Contact("sole", box, table, law=fm.laws.Coulomb(mu_s=1.0), normal_force=mu_g)
end = n * (rise + fall)
sol = fm.simulate(fm.Scene("conveyor", [box, table, sole]), t_end=end, rtol=1e-10, t_eval=np.linspace(0.0, end, 1101))

figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.4, 4.4), sharex=True, layout="constrained")
top.plot(sol.t, sol.velocity("box.x"), sol.t, sol.velocity("box.x") - sol.relative_velocity("sole")[0], "--")
top.set(ylabel="speed (m/s)", title="box, and the table dashed")
bottom.plot(sol.t, 1e3 * (sol["box.x"] - sol["table.x"]))
bottom.set(xlabel="time (s)", ylabel="gained (mm)")
plt.show()

tau = V * (1 + a1 / a2) / (a1 + mu_g)
closed = 0.5 * V * (1 - mu_g / a2) * tau
at = sol.at(np.array([3.0, 4.0]) * (rise + fall))
gained = np.diff(at["box.x"] - at["table.x"])[0]
print(f"gains {1e3 * gained:.9f} mm in a period, closed form {1e3 * closed:.9f} mm")
assert abs(gained / closed - 1) < 1e-8
