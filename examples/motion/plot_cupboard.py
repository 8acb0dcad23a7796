r"""
Does a pushed cupboard slide or tip?
====================================

It slides under :math:`\mu m g`. Pushed at height h its feet, b apart, then bear :math:`\frac{mg}{2} \pm \mu m
g\frac{h}{b}` (moments about a foot): above :math:`h = b/(2\mu)` the rear foot would have to pull, and it tips first.

The higher the push, the more the front foot bears and the less the rear one. At the dashed line the rear foot bears
nothing.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

m, g, mu, b, H = 40.0, 9.81, 0.35, 0.6, 1.0


def feet(h):
    """Shares of the weight on the rear and the front foot while it slides, pushed at the height h."""
    points = {"rear": (-b / 2, -H), "front": (b / 2, -H), "hand": (-b / 2, h - H)}
    box = fm.RigidBody("box", mass=m, inertia=5.0, position=(0.0, H), velocity=(1e-3, 0.0), points=points)
    parts = [box, fm.Gravity("gravity", acceleration={"y": -g})]
    for foot in ("rear", "front"):
        parts.append(fm.RollerOnLine(foot, box.point(foot), push_only=True, friction=fm.laws.Coulomb(mu_s=mu)))
    parts.append(fm.Force("push", box.point("hand"), axis="x", value=mu * m * g))
    sol = fm.simulate(fm.Scene("cupboard", parts), t_end=0.05)
    return sol.normal_force("rear")[-1] / (m * g), sol.normal_force("front")[-1] / (m * g)


heights = np.linspace(0.1, 0.95 * b / (2 * mu), 8)
found = np.array([feet(h) for h in heights]).T
closed = np.array([0.5 - mu * heights / b, 0.5 + mu * heights / b])
figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(heights, closed[0], "C0", heights, closed[1], "C1", heights, found[0], "C0o", heights, found[1], "C1s")
ax.axvline(b / (2 * mu), color="0.6", linestyle="--")
ax.set(xlabel="height of the push (m); dashed: it tips", ylabel="load of the feet / weight")
ax.legend(["rear", "front"], loc="upper left")
plt.show()
print(f"loads agree to {np.abs(found - closed).max():.1e} of the weight; it tips above {b / (2 * mu):.3f} m")
assert np.abs(found - closed).max() < 1e-9
