r"""
When does a fault creep, and when does it quake?
================================================

Friction of rock weakens by :math:`b - a` with each e-fold of speed, but only over a distance :math:`L` of slip. Pulled
through a spring stiffer than :math:`k_c = \frac{N(b-a)}{L}\left(1 + \frac{mV^2}{NaL}\right)` it creeps, through a
softer one it quakes: J. R. Rice and A. L. Ruina, J. Appl. Mech. 50 (1983) 343-349 (the roots of the linearised
equations).

On the left the spring is softer than the critical one, and a small disturbance grows. On the right it is stiffer,
and the disturbance dies out.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

a, b, L, V, N, m = 0.010, 0.015, 1e-5, 1e-3, 1e6, 2e4  # metres, seconds, newtons
rock, plate = fm.Body("rock", mass=m), fm.Driven("plate", velocity={"x": V})
law = fm.laws.RateAndState(mu_0=0.6, a=a, b=b, L=L, v_0=V, v_rest=1e-9)
scene = fm.Scene("fault", [
    rock, plate, fm.Spring("crust", rock, axis="x", stiffness=4e8),
    fm.Contact("fault", rock, plate, law=law, normal_force=N),
])  # fmt: skip
closed = N * (b - a) / L * (1 + m * V**2 / (N * a * L))
modes = fm.analysis.complex_eigenvalues(scene, over="crust.stiffness", values=np.linspace(0.8, 1.3, 11) * closed)
(critical,) = modes.critical

figure, axes = plt.subplots(1, 2, figsize=(7.4, 3.2), sharey=True, layout="constrained")
for ax, share in zip(axes, (0.95, 1.05), strict=True):
    start = {"crust.stiffness": share * closed, "rock.position.x": 0.6 * N / (share * closed) + 1e-7}
    sol = fm.simulate(scene.with_parameters(start), t_end=1.0, rtol=1e-6)
    fine = sol.at(np.linspace(0.0, 1.0, 2001))
    ax.plot(fine.t, -fine.relative_velocity("fault")[0] / V, linewidth=0.8)
    ax.set(title=f"stiffness {share} $k_c$", xlabel="time (s)")
axes[0].set_ylabel("slip speed / V")
plt.show()

print(f"critical stiffness {critical.value:.3f} N/m, closed form {closed:.3f} N/m")
assert abs(critical.value / closed - 1) < 1e-8
