"""
The catalogue of friction laws
==============================

The coefficient of every law in steady slip, for the values of its ``example()``.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm
from fricmb.plot._law import speed_range

names = [name for name in fm.laws.names if not name.startswith("Contensou")]
figure, axes = plt.subplots(7, 5, figsize=(11, 13), layout="constrained")
for ax in axes.flat:
    ax.set_visible(False)
for ax, name in zip(axes.flat, names, strict=False):
    law = getattr(fm.laws, name).example()
    r = speed_range(law)
    ax.set_visible(True)
    ax.semilogx(r, law.coefficient(r))
    ax.set_ylim(bottom=0)
    ax.set_title(name, fontsize="small")
    ax.tick_params(labelsize="x-small")
figure.supxlabel("slip speed")
figure.supylabel("coefficient in steady slip")

# %%
# A disc that slides and spins loses its sliding friction to the spin: exact, and in Pade's form.
ratio = np.linspace(0.02, 4, 200)
velocity = np.vstack([ratio, np.zeros_like(ratio), np.ones_like(ratio)])
exact = fm.laws.Contensou(mu=1.0, v_reg=1e-9).force(velocity, 1.0)
pade = fm.laws.ContensouPade(mu=1.0, v_reg=1e-9).force(velocity, 1.0)
figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
ax.plot(ratio, -exact[0], label="sliding")
ax.plot(ratio, -exact[2], label="spinning, moment over radius")
ax.plot(ratio, -pade[0], "--", label="sliding, Pade")
ax.plot(ratio, -pade[2], "--", label="spinning, Pade")
ax.set_xlabel("v / (R omega)")
ax.set_ylabel("friction / (mu N)")
ax.legend()

assert 0.35 < np.abs(exact - pade).max() < 0.36
