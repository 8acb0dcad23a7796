"""
Why transitions in the plane are hard
=====================================

A puck slides on a rough floor under a constant push along x.  Its speed is smooth to the end; the *direction* of its
slip is not, and the friction force follows the direction.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm


def push(load, velocity, *, mu_s=1.0, mu_k=1.0):
    """A puck of mass 1 and weight 1 under a force along x."""
    puck = fm.Body("puck", mass=1.0, axes="xy", velocity={"x": velocity[0], "y": velocity[1]})
    floor = fm.Contact("floor", puck, law=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), normal_force=1.0)
    return fm.Scene("push", [puck, fm.Force("push", puck, axis="x", value=load), floor])


# %%
# **Landing.**  With a push :math:`a` below the friction :math:`c` the puck comes to rest at :math:`t^*`.  The angle of
# its slip against the push falls like :math:`(t^* - t)^p`, :math:`p = a/(c - a)`: a straight line in this picture, of a
# slope that is no whole number.  A polynomial through such points has an error that no order makes small.

figure, ax = plt.subplots(layout="constrained")
left = np.geomspace(3e-4, 0.3, 60)
for load, style in ((0.2, "-"), (0.4, "--"), (0.6, "-.")):
    sol = fm.simulate(push(load, (0.0, 1.0)), t_end=4.0, rtol=1e-11)
    rest = sol.events.of(kind="stick").t[0]
    vx, vy = sol(rest - left)[2:]
    angle = np.arctan2(vy, vx)
    slope = np.polyfit(np.log(left[:15]), np.log(angle[:15]), 1)[0]
    ax.loglog(left, angle, style, label=f"a/c = {load}: slope {slope:.3f}, p = {load / (1 - load):.3f}")
    assert abs(slope - load / (1 - load)) < 0.015
ax.set(xlabel="time until rest", ylabel="angle between slip and push")
ax.legend()

# %%
# **Turning.**  With a push above the friction nothing can hold the puck.  Thrown against the push, a little beside it,
# it comes nearly to rest, turns round, and is off again.  The nearer the miss, the faster the turn.  No velocity is so
# small that it means rest.

figure, ax = plt.subplots(layout="constrained")
for beside, style in ((1e-1, "-"), (1e-2, "--"), (1e-3, "-."), (1e-4, ":")):
    sol = fm.simulate(push(1.1, (-1.0, beside)), t_end=3.0, rtol=1e-10)
    t = np.linspace(0.35, 0.65, 4001)
    vx, vy = sol(t)[2:]
    least = np.hypot(*sol.v).min()
    ax.plot(t, np.degrees(np.arctan2(vy, vx)), style, label=f"thrown {beside:g} beside it: least speed {least:.0e}")
    assert len(sol.events.of(kind="stick")) == 0
ax.set(xlabel="time", ylabel="direction of slip (degrees)")
ax.legend(loc="upper right", fontsize="x-small")

# %%
# **Hit or miss.**  With a higher break-away the same throw sticks if it hits rest exactly, and turns if it misses by
# a hair: the outcome is a discontinuous function of the start.

held = {}
for beside in (0.0, 1e-6):
    sol = fm.simulate(push(1.1, (-1.0, beside), mu_s=1.2), t_end=3.0, rtol=1e-10)
    held[beside] = sol.mode("floor")[-1] == 0
print({f"thrown {beside:g} beside": "sticks" if stuck else "turns" for beside, stuck in held.items()})
assert held == {0.0: True, 1e-6: False}

# %%
# **Start.**  Under a push that grows, slip starts at the instant at which the push reaches break-away.  Where that
# is above friction in slip, speed grows like the time; where they are equal, like its square, and at the very
# start the force has no direction but that of the load.

figure, ax = plt.subplots(layout="constrained")
for mu_s, power, style in ((1.5, 1, "-"), (1.0, 2, "--")):
    sol = fm.simulate(push(fm.t, (0.0, 0.0), mu_s=mu_s), t_end=3.0, rtol=1e-11)
    start = sol.events.of(kind="slip").t[0]
    after = np.geomspace(1e-4, 0.5, 60)
    speed = sol(start + after)[2]
    slope = np.polyfit(np.log(after[:20]), np.log(speed[:20]), 1)[0]
    ax.loglog(after, speed, style, label=f"break-away {mu_s}: slope {slope:.3f}")
    assert abs(start - mu_s) < 1e-9
    assert abs(slope - power) < 0.01
ax.set(xlabel="time since the start of slip", ylabel="slip speed")
ax.legend()
plt.show()
