r"""
When does a sliding billiard ball begin to roll?
================================================

Friction slows the ball and turns it. The moment :math:`\mu m g R` on the inertia :math:`\frac25 m R^2` acts on the
speed of the rim :math:`R\omega` like a force on a mass of :math:`\frac25 m`, so ball and rim are two bodies that rub on
each other. They meet at :math:`t = 2 v_0/(7\mu g)` with :math:`\frac57 v_0`, whatever the friction.

The two speeds approach each other in straight lines and are equal from the moment of rolling on.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

m, mu, g, v0 = 0.17, 0.2, 9.81, 3.0
ball = fm.Body("ball", mass=m, velocity={"x": v0})
rim = fm.Body("rim", mass=0.4 * m)
cloth = fm.Contact("cloth", ball, rim, law=fm.laws.Coulomb(mu_s=mu), normal_force=m * g)
sol = fm.simulate(fm.Scene("billiards", [ball, rim, cloth]), t_end=0.8, rtol=1e-10, t_eval=np.linspace(0.0, 0.8, 401))

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(sol.t, sol.velocity("ball.x"), label="centre, $v$")
ax.plot(sol.t, sol.velocity("rim.x"), label="rim, $R\\omega$")
ax.set(xlabel="time (s)", ylabel="speed (m/s)")
ax.legend()
plt.show()

rolls = sol.events[0]
print(f"rolls from {rolls.t:.9f} s, closed form {2 * v0 / (7 * mu * g):.9f} s; {sol.velocity('ball.x')[-1]:.9f} m/s")
assert rolls.kind == "stick"
assert abs(rolls.t / (2 * v0 / (7 * mu * g)) - 1) < 1e-9
assert abs(sol.velocity("ball.x")[-1] / (5 * v0 / 7) - 1) < 1e-9
