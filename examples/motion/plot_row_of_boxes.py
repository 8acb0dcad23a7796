"""
How many boxes of a row feel a push?
====================================

Boxes stand in a row with springs between them, and the first one is pushed harder and harder. Slowly pushed, n boxes
that slide resist with n times the friction f of one: the next one starts when the push reaches (n + 1) f, and no box
beyond feels anything.

Each line is a box. Box n leaves the axis when the push reaches n + 1 times the friction of one.
"""

from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

n, f, rate = 8, 1.0, 0.02
boxes = [fm.Body(f"box{i}", mass=0.05) for i in range(1, n + 1)]
law = fm.laws.Coulomb(mu_s=1.0)
scene = fm.Scene("row", [
    *boxes, fm.Force("push", boxes[0], axis="x", value=rate * fm.t),
    *(fm.Contact(f"floor{i}", box, law=law, normal_force=f) for i, box in enumerate(boxes, 1)),
    *(fm.Spring(f"k{i}", a, b, axis="x", stiffness=10.0) for i, (a, b) in enumerate(pairwise(boxes), 1)),
    *(fm.Damper(f"c{i}", a, b, axis="x", damping=1.0) for i, (a, b) in enumerate(pairwise(boxes), 1)),
])  # fmt: skip
sol = fm.simulate(scene, t_end=395.0, rtol=1e-7)
reach = np.array([sol.events.of(contact=f"floor{i}", kind="slip").t[0] * rate for i in range(1, n)])

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
for i in range(1, n + 1):
    ax.plot(rate * sol.t / f, sol[f"box{i}.x"], color=plt.cm.viridis(i / (n + 1)), label=f"box {i}")
ax.set(xlabel="push / friction of one box", ylabel="displacement of the boxes")
ax.legend(fontsize="small", ncols=2)
plt.show()

print("they start at a push of", np.round(reach, 3), "f")
assert np.abs(reach / np.arange(1, n) - 1).max() < 0.01
