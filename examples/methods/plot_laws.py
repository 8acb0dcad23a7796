"""
The catalogue of friction laws
==============================

Every law for the values of its ``example()``: of laws with memory the loops of friction over displacement in harmonic
cycles of three amplitudes, of all others the coefficient over the slip speed, and what holds at rest (dashed).
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

names = [name for name in fm.laws.names if not name.startswith("Contensou")]
figure, axes = plt.subplots(7, 5, figsize=(11, 13), layout="constrained")
for ax in axes.flat:
    ax.set_visible(False)
for ax, name in zip(axes.flat, names, strict=False):
    law = getattr(fm.laws, name).example()
    fm.plot.law(law, ax=ax)
    ax.set_visible(True)
    if ax.get_legend():
        ax.get_legend().remove()
        ax.autoscale(axis="x")  # no room for names
    ax.set(xlabel="displacement" if law.states else "slip speed", ylabel="")
    ax.xaxis.label.set_size("x-small")
    ax.set_title(name, fontsize="small")
    ax.tick_params(labelsize="x-small")
    ax.xaxis.get_offset_text().set_size("x-small")
figure.supylabel("friction / normal force")

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
