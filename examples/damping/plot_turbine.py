r"""
How hard should a damper press on a turbine blade?
==================================================

Neither loosely nor so hard that it only follows. A damper of stiffness :math:`k_d` that slips at :math:`F = \mu N`
takes :math:`4 F (a - F/k_d)` from a blade that moves by :math:`\pm a`: F times the distance that it slips in a
period. That is most at :math:`F = k_d a/2`, and nothing from :math:`k_d a` on.

The curve is the formula, the dots are runs. To the left of the maximum the damper slips nearly all the time, to the
right it hardly slips at all.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

a, k_d, omega = 1e-4, 2e6, 2 * np.pi * 200.0
blade = fm.Driven("blade", position={"x": a * sympy.sin(omega * fm.t)})
damper = fm.Body("damper", mass=1e-4)
platform = fm.Contact("platform", damper, law=fm.laws.Coulomb(mu_s=1.0), normal_force=50.0)
scene = fm.Scene("blade", [damper, blade, fm.Spring("k", damper, blade, axis="x", stiffness=k_d),
                           fm.Damper("c", damper, blade, axis="x", damping=5.0), platform])  # fmt: skip
shares = np.array([0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9])
loss = []
for F in shares * k_d * a:
    sol = fm.simulate(scene.with_parameters({"platform.normal_force": F}), t_end=0.03, rtol=1e-7, t_eval=[0.02, 0.03])
    loss.append(np.diff(sol.energy.friction_loss)[0] / 2)
F = np.linspace(0.0, 1.0, 101)

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(F, 4 * F * (1 - F))
ax.plot(shares, np.array(loss) / (k_d * a**2), "o")
ax.set(xlabel="friction $F/(k_d a)$", ylabel="loss a period / $(k_d a^2)$")
plt.show()
closed = 4 * shares * (1 - shares) * k_d * a**2
print(f"loss over closed form: {np.round(np.array(loss) / closed, 5)}")
assert np.abs(np.array(loss) / closed - 1).max() < 1e-3
