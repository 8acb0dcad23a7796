r"""
How fast does clutch judder grow?
=================================

A lining whose friction falls with slip speed by :math:`\mu'` acts as a negative damper. A small swing of the drive line
(inertia :math:`m`, damping :math:`c`) then grows like :math:`e^{\alpha t}` with :math:`\alpha = -(c + \mu' N)/(2m)`.

The dashed lines are the exponential of the formula.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

m, k, c, N, V = 0.5, 800.0, 0.5, 100.0, 5.0
law = fm.laws.Stribeck(mu_s=0.4, mu_k=0.2, v_s=10.0, exponent=1.0)
line = fm.Body("line", mass=m, position={"x": law.coefficient(V) * N / k + 1e-4})
engine = fm.Driven("engine", velocity={"x": V})
scene = fm.Scene("clutch", [
    line, engine, fm.Spring("shaft", line, axis="x", stiffness=k), fm.Damper("damper", line, axis="x", damping=c),
    fm.Contact("lining", line, engine, law=law, normal_force=N),
])  # fmt: skip
sol = fm.simulate(scene, t_end=4.0, rtol=1e-10, t_eval=np.linspace(0.0, 4.0, 8001))
swing = sol["line.x"] - law.coefficient(V) * N / k
alpha = -(c + law.derivative(V) * N) / (2 * m)

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(sol.t, 1e3 * swing, linewidth=0.8)
for sign in (1, -1):
    ax.plot(sol.t, sign * 0.1 * np.exp(alpha * sol.t), "--", color="tab:orange")
ax.set(xlabel="time (s)", ylabel="swing of the drive line (mrad)", title=f"grows by exp({alpha:.3f} t)")
plt.show()

tops = [i for i in range(1, 8000) if swing[i - 1] < swing[i] > swing[i + 1]]
measured = math.log(swing[tops[-1]] / swing[tops[0]]) / (sol.t[tops[-1]] - sol.t[tops[0]])
print(f"growth {measured:.6f} 1/s, closed form {alpha:.6f} 1/s")
assert abs(measured / alpha - 1) < 1e-3
