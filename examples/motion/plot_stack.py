"""
In which order does a moving table catch blocks on it?
======================================================

Three blocks lie on each other on a table that moves off at 1 m/s. The joints are coupled through the blocks between
them, and are caught one after the other.

Above are the speeds of the blocks, below the transitions. The lowest block is caught first, the highest one last.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

gravity = 9.81
scene = fm.models.block_stack(3, gravity=gravity, mu_s=(0.5, 0.3, 0.2))
sol = fm.simulate(scene, t_end=0.7, rtol=1e-9)

figure, axes = plt.subplots(2, 1, figsize=(7, 5.5), layout="constrained", sharex=True)
sol.plot.velocities(ax=axes[0])
sol.plot.transitions(ax=axes[1])
plt.show()

# %%
# Accelerations are constant in between, so each catch has a closed form: the lowest block gains
# 0.5 * 3 - 0.3 * 2 = 0.9 g, the next 0.3 * 2 - 0.2 = 0.4 g, the top 0.2 g.

caught = {event.contact: event.t for event in sol.events if event.kind == "stick"}
expected = {"joint1": 1 / (0.9 * gravity), "joint2": 1 / (0.4 * gravity), "joint3": 1 / (0.2 * gravity)}
print({name: (caught[name], expected[name]) for name in expected})
assert np.allclose([caught[name] for name in expected], list(expected.values()), rtol=1e-9)
