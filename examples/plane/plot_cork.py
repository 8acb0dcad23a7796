r"""
Why does a cork come out if you turn it?
========================================

Friction has one size and the direction of slip. Pulled out at v while its rim turns at u, the cork is held along its
axis by :math:`\mu N v/\sqrt{v^2 + u^2}` only: turned fast, it takes hardly any pull.

The line is the formula, the dots are runs: turned three times as fast as it is pulled, the cork needs a third of
the pull.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

grip, v = 100.0, 0.01  # N, m/s; x is along the axis of the bottle, y round it
cork, hand = fm.Body("cork", mass=0.01, axes="xy"), fm.Driven("hand", velocity={"x": v, "y": 0.0})
scene = fm.Scene("bottle", [
    cork, hand, fm.Contact("neck", cork, law=fm.laws.Coulomb(mu_s=1.0), normal_force=grip),
    *(fm.Spring(f"k{axis}", cork, hand, axis=axis, stiffness=2e4) for axis in "xy"),
    *(fm.Damper(f"c{axis}", cork, hand, axis=axis, damping=10.0) for axis in "xy"),
])  # fmt: skip
turns, pull = np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0]), []
for turn in turns:
    sol = fm.simulate(scene.with_parameters({"hand.velocity.y": turn * v}), t_end=3.0, rtol=1e-8)
    pull.append(-sol.force("neck")[0, -1])
closed = grip / np.sqrt(1 + turns**2)

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
u = np.linspace(0.0, 8.0, 100)
ax.plot(u, grip / np.sqrt(1 + u**2), turns, pull, "o")
ax.set(xlabel="speed round the axis / speed along it", ylabel="pull (N)", ylim=(0.0, None))
plt.show()
print(f"pull {np.round(pull, 4)} N, closed form {np.round(closed, 4)} N")
assert np.abs(pull / closed - 1).max() < 1e-4
