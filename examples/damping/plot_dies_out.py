r"""
How does a swing die out under dry friction?
============================================

Along a straight line: in each half swing the mass moves about the point displaced by :math:`F/k`, so the next turn is
nearer by :math:`2F/k` (the damper of a washing machine). It stops at the first turn nearer than :math:`F/k`.

The dashed lines join the turning points of the formula. They are straight, where viscous damping would give curves
that never end.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

m, k, F, x0 = 2.0, 800.0, 6.0, 0.085
drum = fm.Body("drum", mass=m, position={"x": x0})
scene = fm.Scene("drum", [
    drum, fm.Spring("spring", drum, axis="x", stiffness=k),
    fm.Contact("strut", drum, law=fm.laws.Coulomb(mu_s=F), normal_force=1.0),
])  # fmt: skip
sol = fm.simulate(scene, t_end=2.0, rtol=1e-10, t_eval=np.linspace(0.0, 2.0, 2001))

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(sol.t, 1e3 * sol["drum.x"])
envelope = x0 - 2 * F / k * sol.t / (np.pi * np.sqrt(m / k))
for sign in (1, -1):
    ax.plot(sol.t, np.where(envelope > F / k, sign * 1e3 * envelope, np.nan), "--", color="0.6")
ax.set(xlabel="time (s)", ylabel="displacement (mm)")
plt.show()

turns = sol.at(sol.events.t)["drum.x"]
closed = [(-1) ** i * (x0 - 2 * i * F / k) for i in range(1, len(turns) + 1)]
print(f"turns and stops at {np.round(1e3 * turns, 6)} mm, closed form {np.round(1e3 * np.array(closed), 6)} mm")
assert np.abs(turns - closed).max() < 1e-9
assert sol.events[-1].kind == "stick"
assert abs(closed[-1]) <= F / k < abs(closed[-2])
