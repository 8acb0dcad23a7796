r"""
Where does a pendulum on a dry pin come to rest?
================================================

Friction in the pin, of radius r, follows its reaction R and so the swing. It takes about the same angle from every
swing, and holds the pendulum askew in the end: weight on its lever is friction on its own,
:math:`m g l \sin\varphi = F r` with :math:`F \le \mu R`.

Above is the angle with the reversals as dots, below the reaction of the pin. The line through the turning points is
almost straight, and the pendulum ends 2 degrees askew.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

scene = fm.models.dry_pendulum()
sol = fm.simulate(scene, t_end=12.0, rtol=1e-8, t_eval=np.linspace(0.0, 12.0, 1201))

# %%
# The angle from the vertical, and what the pin carries. Each reversal and the last stick is an event.
figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(7, 5.5), layout="constrained")
angle = sol["arm.angle"] + np.pi / 2
above.plot(sol.t, angle)
above.plot(sol.events.t, sol.at(sol.events.t)["arm.angle"] + np.pi / 2, ".")
above.set_ylabel("angle from the vertical (rad)")
below.plot(sol.t, sol.normal_force("pin"))
below.set_ylabel("reaction of the pin (N)")
below.set_xlabel("t (s)")
plt.show()

# %%
# At rest friction carries what is askew: weight times lever is friction times radius.
rest = sol.force("pin")[0, -1] * 0.05
assert abs(rest - 1.3 * 9.81 * 0.7 * np.sin(angle[-1])) < 1e-8
assert [event.kind for event in sol.events].count("stick") == 1
print(
    f"at rest {np.degrees(angle[-1]):.3f} degrees askew after {len(sol.events)} swings, at t = {sol.events.t[-1]:.6f} s"
)
