r"""
How much does a capstan add to the pull of a hand?
==================================================

Rope over the angle :math:`d\varphi` of a turning drum is pressed on by :math:`T d\varphi` and pulled by :math:`\mu T
d\varphi`: tension grows by :math:`e^{\mu\varphi}` (L. Euler, 1769). Of 24 pieces of rope, pressed on by the mean
tension of their ends, each makes :math:`(1 + \mu d\varphi/2)/(1 - \mu d\varphi/2)`.

The tension grows exponentially round the drum, a straight line on this axis; dots are the tensions between the
pieces.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

mu, phi, n, k, T0 = 0.3, 3 * math.pi, 24, 2e3, 10.0  # one turn and a half
d, law = phi / n, fm.laws.Coulomb(mu_s=mu)
rope = [fm.Body(f"p{i}", mass=1e-2) for i in range(n)]
x = [fm.coordinate(f"p{i}.x") for i in range(n)] + [0]
T = [T0] + [k * (x[i + 1] - x[i]) for i in range(n)]
links = zip(rope, [*rope[1:], fm.GROUND], strict=True)
scene = fm.Scene("capstan", [
    *rope, fm.Force("hand", rope[0], axis="x", value=-T0),
    *(fm.Spring(f"k{i}", a, b, axis="x", stiffness=k) for i, (a, b) in enumerate(links)),
    *(fm.Contact(f"drum{i}", piece, law=law, normal_force=d * (T[i] + T[i + 1]) / 2, axes="x", slide=2.0)
      for i, piece in enumerate(rope)),
])  # fmt: skip
sliding = fm.analysis.steady_sliding(scene)
tension = np.concatenate([[T0], k * np.diff([*sliding.q, 0.0])])

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.semilogy(d * np.arange(n + 1), tension, "o", d * np.arange(n + 1), T0 * np.exp(mu * d * np.arange(n + 1)), "-")
ax.set(xlabel="angle round the drum (rad)", ylabel="tension of the rope (N)")
plt.show()

pieces = ((1 + mu * d / 2) / (1 - mu * d / 2)) ** n
print(f"gain {tension[-1] / T0:.9f}, of {n} pieces {pieces:.9f}, Euler {math.exp(mu * phi):.4f}")
assert abs(tension[-1] / T0 / pieces - 1) < 1e-9
