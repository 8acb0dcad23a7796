r"""
When does a hinge squeak?
=========================

When it is opened slowly: friction that falls with speed feeds the swinging leaf by :math:`-\mu'(v) N` against its
damping :math:`c`. With :math:`\mu = \mu_k + (\mu_s - \mu_k) e^{-v/v_s}` they are equal at :math:`v_c = v_s \ln\,((\mu_s
- \mu_k) N/(c v_s))`; below that speed steady sliding is lost.

On the left the hinge is opened more slowly than the critical speed: the leaf begins to stick and slip. On the right
it is opened faster and turns smoothly.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

mu_s, mu_k, v_s, N, c = 0.4, 0.2, 0.01, 20.0, 40.0
leaf, pin = fm.Body("leaf", mass=0.1), fm.Driven("pin", velocity={"x": 0.02})
law = fm.laws.Stribeck(mu_s=mu_s, mu_k=mu_k, v_s=v_s, exponent=1.0)
scene = fm.Scene("hinge", [
    leaf, pin, fm.Spring("k", leaf, axis="x", stiffness=4e5), fm.Damper("c", leaf, axis="x", damping=c),
    fm.Contact("eye", leaf, pin, law=law, normal_force=N),
])  # fmt: skip
closed = v_s * math.log((mu_s - mu_k) * N / (c * v_s))
(critical,) = fm.analysis.complex_eigenvalues(scene, over="pin.velocity.x", values=[0.005, 0.05]).critical

figure, axes = plt.subplots(1, 2, figsize=(7.4, 3.2), sharey=True, layout="constrained")
for ax, share in zip(axes, (0.8, 1.2), strict=True):
    steady = {"pin.velocity.x": share * closed, "leaf.position.x": law.coefficient(share * closed) * N / 4e5 + 2e-7}
    sol = fm.simulate(scene.with_parameters(steady), t_end=0.25, rtol=1e-8)
    fine = sol.at(np.linspace(0.0, 0.06, 2001))
    ax.plot(1e3 * fine.t, 1e3 * fine.velocity("leaf.x"), linewidth=0.8)
    ax.set(title=f"pin at {1e3 * share * closed:.1f} mm/s", xlabel="time (ms)")
axes[0].set_ylabel("speed of the leaf (mm/s)")
plt.show()

print(f"squeaks below {critical.value:.12f} m/s, closed form {closed:.12f}")
assert abs(critical.value / closed - 1) < 1e-9
