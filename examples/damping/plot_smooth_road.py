r"""
Why does a leaf spring ride hard on a smooth road?
==================================================

Its leaves rub on each other with the force F. Until the body's inertia exceeds that, they stick and the wheel's every
motion goes straight through: on waves of height a and frequency :math:`\omega` the spring is a rigid block as long as
:math:`m a \omega^2 < F`.

The frequency of the waves rises along the axis. Up to the critical one body and wheel move as one; beyond it the
body moves less and less.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

m, F, a, rise = 500.0, 1500.0, 0.01, 2.0  # kg, N, m; the frequency rises by 2 rad/s in a second
road = fm.Driven("road", position={"x": a * sympy.sin(rise * fm.t**2 / 2)})
body = fm.Body("body", mass=m)
scene = fm.Scene("ride", [
    body, road, fm.Spring("leaves", body, road, axis="x", stiffness=2e4),
    fm.Contact("rub", body, road, law=fm.laws.Coulomb(mu_s=F), normal_force=1.0),
])  # fmt: skip
sol = fm.simulate(scene, t_end=14.0, rtol=1e-9, t_eval=np.linspace(0.0, 14.0, 4001))

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(rise * sol.t, 1e3 * sol["road.x"], color="0.7", label="wheel")
ax.plot(rise * sol.t, 1e3 * sol["body.x"], label="body")
ax.set(xlabel="frequency of the waves (rad/s)", ylabel="height (mm)")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
plt.show()
t = sol.events.of(kind="slip").t[0]
needed = m * a * (rise * np.cos(rise * t**2 / 2) - (rise * t) ** 2 * np.sin(rise * t**2 / 2))
print(f"they let go at {t:.6f} s, where the body needs {abs(needed):.6f} N of {F:g} N")
assert abs(abs(needed) / F - 1) < 1e-6
