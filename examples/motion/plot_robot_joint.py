r"""
How far does a robot's joint trail its target?
==============================================

Its controller turns it with :math:`k_p` times the error, so dry friction F costs an error of :math:`F/k_p`; where the
joint turns round it stands until the target has come back by twice that. At the turn the joint's own deceleration
helps, :math:`(F - J A \omega^2)/k_p` is left. Four times the gain trails a quarter.

The error is flat while the joint turns, and changes sign while the joint stands at its turning points. With four
times the gain it is a quarter.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

J, F, A, omega = 0.02, 0.8, 0.5, 1.0  # kg m^2, N m, rad, rad/s
target = A * sympy.sin(omega * fm.t)
error, rate = target - fm.coordinate("joint.x"), target.diff(fm.t) - fm.speed("joint.x")
joint = fm.Body("joint", mass=J)
scene = fm.Scene("joint", [
    joint, fm.Force("motor", joint, axis="x", value=fm.parameter("kp", 10.0) * error + rate),
    fm.Contact("gear", joint, law=fm.laws.Coulomb(mu_s=F), normal_force=1.0),
])  # fmt: skip

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
for gain in (10.0, 40.0):
    sol = fm.simulate(scene.with_parameters({"kp": gain}), t_end=10.0, rtol=1e-8, t_eval=np.linspace(0.0, 10.0, 1001))
    ax.plot(sol.t, A * np.sin(omega * sol.t) - sol["joint.x"], label=f"$k_p$ = {gain:g} N m/rad")
    turns = sol.events.of(kind="stick").t
    trail, closed = np.abs(A * np.sin(omega * turns) - sol.at(turns)["joint.x"]), (F - J * A * omega**2) / gain
    print(f"gain {gain:g}: trails {trail[-1]:.6f} rad at the turn, closed form {closed:.6f} rad")
    assert np.abs(trail / closed - 1).max() < 2e-4
ax.set(xlabel="time (s)", ylabel="error (rad)")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
plt.show()
