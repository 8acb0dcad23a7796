r"""
How fast does the bit of a sticking drill string turn?
======================================================

It stands until the pipe has wound up to break-away, :math:`D` above what slip needs, and swings free about the speed
:math:`\Omega` of the table with amplitude :math:`\sqrt{\Omega^2 + (D\omega)^2}` (it starts with speed 0, displaced by
:math:`D`): its peak is :math:`\Omega + \sqrt{\Omega^2 + (D\omega)^2}`, more than twice the table's.

The bit stands still, then spins up to more than twice the speed of the table, again and again; the mean is the
speed of the table.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

inertia, pipe, table_speed, static, kinetic = 400.0, 500.0, 6.0, 8000.0, 6000.0  # kg m^2, N m/rad, rad/s, N m
bit, table = fm.Body("bit", mass=inertia), fm.Driven("table", velocity={"x": table_speed})
law = fm.laws.Coulomb(mu_s=static, mu_k=kinetic)
scene = fm.Scene("drill string", [
    bit, table, fm.Spring("pipe", bit, table, axis="x", stiffness=pipe),
    fm.Contact("rock", bit, law=law, normal_force=1.0),
])  # fmt: skip
sol = fm.simulate(scene, t_end=60.0, rtol=1e-9, t_eval=np.linspace(0.0, 60.0, 12001))

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(sol.t, sol.velocity("bit.x"), label="bit")
ax.axhline(table_speed, color="tab:orange", linestyle="--", label="table")
ax.set(xlabel="time (s)", ylabel="speed (rad/s)")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
plt.show()

D, omega = (static - kinetic) / pipe, math.sqrt(pipe / inertia)
closed = table_speed + math.hypot(table_speed, D * omega)
print(f"peak {sol.velocity('bit.x').max():.6f} rad/s, closed form {closed:.6f} rad/s")
assert abs(sol.velocity("bit.x").max() / closed - 1) < 1e-5
