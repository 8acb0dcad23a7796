"""
A long chain: cost against size
===============================

Blocks on a slow belt, spring to spring, each a little different: the first to break away tears its neighbours off, and
an avalanche runs through the chain.  A transition moves only the few blocks around it within a step, so the cost of a
run grows in proportion to the number of blocks.
"""

# %%
# The same run for chains of different length, each for the second time (the first one builds and loads).

import time

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

grid = np.arange(0.0, 20.01, 0.5)


def measure(n):
    """The second run of a chain of n blocks, and its seconds a step."""
    scene = fm.models.stick_slip_chain(n)
    fm.simulate(scene, t_end=20.0, t_eval=grid, rtol=1e-4)
    begin = time.perf_counter()
    sol = fm.simulate(scene, t_end=20.0, t_eval=grid, rtol=1e-4)
    return sol, (time.perf_counter() - begin) / sol.stats.n_steps


sizes = [100, 300, 1000, 3000, 10000]
runs = [measure(n) for n in sizes]
seconds = np.array([each for _, each in runs])
for n, (sol, each) in zip(sizes, runs, strict=True):
    print(f"{n:6d} blocks: {sol.stats.n_steps} steps of {1e3 * each:.3f} ms, {len(sol.events)} transitions")

# %%
# The slope in this picture is the exponent of the cost of a step; a constant part shows at the left end.

slope = np.polyfit(np.log(sizes[1:]), np.log(seconds[1:]), 1)[0]
figure, ax = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
ax.loglog(sizes, 1e3 * seconds, "o-", label=f"measured, exponent {slope:.2f}")
ax.loglog(sizes, 1e3 * seconds[-1] * np.array(sizes) / sizes[-1], "--", color="grey", label="in proportion")
ax.set(xlabel="blocks", ylabel="milliseconds a step")
ax.legend()
plt.show()

# %%
# The avalanche in the chain of a thousand: where and when blocks break away and are caught.

events = runs[2][0].events
where = np.array([int(event.contact.removeprefix("sole")) for event in events])
kind = np.array([event.kind == "slip" for event in events])
figure, ax = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
ax.plot(where[kind], events.t[kind], ".", ms=2, color="tab:blue", label="slip")
ax.plot(where[~kind], events.t[~kind], ".", ms=2, color="tab:orange", label="stick")
ax.set(xlabel="block", ylabel="time")
ax.legend(markerscale=5, loc="center right")
plt.show()

# %%
# The number of steps does not depend on the size, and the number of transitions a block settles.

steps = [sol.stats.n_steps for sol, _ in runs]
assert max(steps) < 1.5 * min(steps)
assert abs(len(runs[-1][0].events) / sizes[-1] - 3.01) < 0.03
