"""
One scene, three regimes
========================

A block on a belt with set-valued friction, with the same law regularised, and with it on bristles: what each
replacement lets creep while the set-valued contact sticks.
"""

import matplotlib.pyplot as plt

import fricmb as fm

scene = fm.models.belt_oscillator(law=fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.05))
regimes = fm.analysis.compare_regimes(scene, "sole", v_reg=1e-3, stiffness=1e3, t_end=30.0, rtol=1e-7)
for regime in regimes:
    print(regime)

# %%
figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), layout="constrained", sharey=True)
for ax, regime in zip(axes, regimes, strict=True):
    sol = regime.solution
    ax.plot(sol.t, sol.relative_velocity("sole")[0])
    ax.set_yscale("symlog", linthresh=1e-7)
    ax.set_title(regime.name)
    ax.set_xlabel("time")
axes[0].set_ylabel("relative velocity")

held, smooth, bristle = regimes
assert held.crept < 1e-8
assert smooth.creep_speed < 2e-3  # of the order of v_reg
