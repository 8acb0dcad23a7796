r"""
Which way does a puck go across a moving belt?
==============================================

Friction in two dimensions at its simplest: a puck is thrown across a belt. Seen from the ground its path is curved;
seen from the belt it is a straight line that ends after :math:`|V|/(\mu g)`.

The two lines are the same motion, seen from the ground and from the belt.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

mu, gravity, belt, across = 0.25, 9.81, 1.0, 1.5
scene = fm.models.puck_on_belt(mu=mu, gravity=gravity, belt=belt, velocity=(0.0, across))
sol = fm.simulate(scene, t_end=1.0, rtol=1e-10, t_eval=np.linspace(0.0, 1.0, 201))

figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
ax.plot(sol["puck.x"], sol["puck.y"], label="on the ground")
ax.plot(sol["puck.x"] - sol["belt.x"], sol["puck.y"], "--", label="on the belt")
ax.set_xlabel("along the belt [m]")
ax.set_ylabel("across [m]")
ax.set_aspect("equal")
ax.legend()
plt.show()

# %%
# When and where it comes to rest on the belt.

V = math.hypot(belt, across)
rest = sol.events[0]
print(f"at rest on the belt at {rest.t:.12f} s, closed form {V / (mu * gravity):.12f} s")
assert rest.kind == "stick"
assert abs(rest.t - V / (mu * gravity)) < 1e-9
assert abs(sol["puck.y"][-1] - across * V / (2 * mu * gravity)) < 1e-9
