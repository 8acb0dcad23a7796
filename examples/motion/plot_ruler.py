r"""
Why do two fingers under a ruler meet in its middle?
====================================================

The farther finger bears less, so it slides - until :math:`\mu_k N` of it has grown to :math:`\mu_s N` of the other.
With distances a, b from the middle they bear :math:`W b/(a+b)` and :math:`W a/(a+b)`, so they change places at
:math:`a/b = \mu_k/\mu_s`, and the distances at which they stop are a geometric series that ends in the middle.

A line is flat while that finger sticks. The fingers slide in turns, and the distances from the middle fall by the
same ratio each time.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

W, v, mu_s, mu_k, far, near = 1.0, 0.01, 0.6, 0.4, 0.45, 0.40  # newtons, metres, seconds
ruler = fm.Body("ruler", mass=1e-3)
left = fm.Driven("left", velocity={"x": v}, position={"x": -far})
right = fm.Driven("right", velocity={"x": -v}, position={"x": near})
x, a, b = (fm.coordinate(name) for name in ("ruler.x", "left.x", "right.x"))
law = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
scene = fm.Scene("ruler", [
    ruler, left, right,
    fm.Contact("left finger", ruler, left, law=law, normal_force=W * (b - x) / (b - a), axes="x"),
    fm.Contact("right finger", ruler, right, law=law, normal_force=W * (x - a) / (b - a), axes="x"),
])  # fmt: skip
sol = fm.simulate(scene, t_end=40.0, rtol=1e-8)

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
for name in ("left", "right"):
    ax.plot(sol.t, 100 * np.abs(sol[f"{name}.x"] - sol["ruler.x"]), label=f"{name} finger")
ax.set(xlabel="time (s)", ylabel="distance from the middle (cm)")
ax.legend()
plt.show()
stops = sol.at([event.t for event in sol.events.of(kind="stick")][1:])
ratio = (stops["left.x"] - stops["ruler.x"]) / (stops["ruler.x"] - stops["right.x"])
ratio = np.minimum(ratio, 1 / ratio)
print(f"ratios of distances {np.round(ratio, 5)}, closed form {mu_k / mu_s:.5f}")
assert np.abs(ratio / (mu_k / mu_s) - 1).max() < 1e-4
