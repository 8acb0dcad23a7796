"""
Order of time stepping through transitions
==========================================

``timestepping`` takes steps over transitions. Halve a fixed step, and the error falls to a quarter, whatever
happens in them: break-away with a coefficient that drops, slip that reverses, a falling law, slip in two dimensions.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm
from fricmb.integrate import integrators

# %%
# Each scene's reference is ``radau`` at 1e-11, which the tests hold against certified digits.

laws = [fm.laws.HyperbolicStribeck(mu_s=mu_s, delta=3.0) for mu_s in (1.0, 1.3)]
scenes = {
    "belt, $\\mu_s > \\mu_k$": (fm.models.belt_oscillator(), 40.0),
    "forced, with reversals": (fm.models.friction_oscillator(friction=0.2, amplitude=0.5, frequency=1.5), 30.0),
    "two blocks, falling laws": (fm.models.stick_slip_chain(2, coupling=1.2, laws=laws), 20.0),
    "brake, two dimensions": (fm.models.brake4dof("2"), 40.0),
}
steps = 0.04 / 2.0 ** np.arange(5)
errors = {}
for name, (scene, t_end) in scenes.items():
    t = np.linspace(0.0, t_end, 81)
    true = fm.simulate(scene, t_end=t_end, t_eval=t, rtol=1e-11, method="radau").q
    runs = [fm.simulate(scene, t_end=t_end, t_eval=t, method=integrators["timestepping"](fixed_step=h)) for h in steps]
    errors[name] = [np.abs(run.q - true).max() / np.abs(true).max() for run in runs]

# %%
# The lines are straight and parallel to the one of order 2.

figure, axes = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
for name, values in errors.items():
    axes.loglog(steps, values, "o-", label=name)
axes.loglog(steps, 0.5 * steps**2, "k--", linewidth=1, label="order 2")
axes.set_xticks(steps, [f"{h:g}" for h in steps])
axes.minorticks_off()
axes.set(xlabel="fixed step", ylabel="largest error / largest position")
axes.legend()
plt.show()

order = {name: np.log2(values[0] / values[-1]) / 4 for name, values in errors.items()}
print(order)
assert min(order.values()) > 1.75
