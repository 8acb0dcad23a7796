r"""
How does shaking smooth dry friction?
=====================================

On a table that shakes fast with the speed :math:`W\cos\Omega t`, a heavy box that drifts with v slips backwards for the
share :math:`\frac{1}{\pi}\arccos(v/W)` of the time. So on average friction is :math:`\frac{2\mu N}{\pi}\arcsin(v/W)`:
the least push P moves it, by :math:`v = W\sin(\pi P/2\mu N)` (J. J. Thomsen, J. Sound Vib. 228 (1999) 1079-1102).

The line is the formula, the dots are runs. Even a small push moves the box, where without shaking it would need the
whole friction: on average, shaking makes dry friction viscous.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

W, fast, weight = 1.0, 2 * np.pi * 100.0, 1.0
box, table = fm.Body("box", mass=1.0), fm.Driven("table", velocity={"x": W * sympy.cos(fast * fm.t)})
scene = fm.Scene("dither", [
    box, table, fm.Force("push", box, axis="x", value=fm.parameter("P", 0.5)),
    fm.Contact("sole", box, table, law=fm.laws.Coulomb(mu_s=1.0), normal_force=weight),
])  # fmt: skip
pushes = np.array([0.1, 0.3, 0.5, 0.7])
drift = []
for P in pushes:
    settled = {"velocity": {"box.x": 0.9 * W * np.sin(np.pi * P / 2)}}
    sol = fm.simulate(scene.with_parameters({"P": P}), t_end=8.0, rtol=1e-6, initial=settled, t_eval=[7.0, 8.0])
    drift.append(np.diff(sol["box.x"])[0])
closed = W * np.sin(np.pi * pushes / (2 * weight))

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
P = np.linspace(0.0, 1.0, 101)
ax.plot(P, W * np.sin(np.pi * P / 2), pushes, drift, "o")
ax.set(xlabel="push / friction", ylabel="speed of drift / W")
plt.show()
print(f"drift over closed form: {np.round(np.array(drift) / closed, 5)}")
assert np.abs(drift / closed - 1).max() < 2e-3
