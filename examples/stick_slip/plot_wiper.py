r"""
How long does a wiper's lip hang when it turns round?
=====================================================

Dragged one way the lip leans by :math:`\mu N/k`, then it leans the other way. In between it sticks to the glass, which
has to come back by :math:`2\mu N/k` from its turn, and carries the lip's mass: it lets go after the time :math:`\tau`
with :math:`(kA - mA\omega^2) \cos\omega\tau = kA - 2\mu N`.

The lip leans to one side, rides on the glass to the other side while it sticks, and leans there.
"""

import math

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

A, omega, mu, N, k, m = 0.4, 2 * math.pi * 0.7, 0.8, 7.5, 1000.0, 0.002
lip = fm.Body("lip", mass=m, position={"x": mu * N / k})
glass = fm.Driven("glass", velocity={"x": A * omega * sympy.cos(omega * fm.t)})
scene = fm.Scene("wiper", [
    lip, glass, fm.Spring("rubber", lip, axis="x", stiffness=k),
    fm.Contact("edge", lip, glass, law=fm.laws.Coulomb(mu_s=mu), normal_force=N),
])  # fmt: skip
sol = fm.simulate(scene, t_end=0.44, rtol=1e-9, t_eval=np.linspace(0.0, 0.44, 1761))

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(sol.t, 1e3 * sol["lip.x"], label="lip leans (mm)")
ax.plot(sol.t, 10 * sol["glass.x"], "--", color="0.6", label="glass (dm)")
ax.set(xlabel="time (s)", ylabel="displacement (mm, dm)")
ax.legend()
plt.show()

stick = next(event.t for event in sol.events if event.kind == "stick" and event.t > 0.2)
slip = next(event.t for event in sol.events if event.kind == "slip" and event.t > stick)
closed = math.acos((k * A - 2 * mu * N) / (k * A - m * A * omega**2)) / omega
print(f"hangs for {slip - stick:.9f} s, closed form {closed:.9f} s")
assert abs((slip - stick) / closed - 1) < 1e-6
