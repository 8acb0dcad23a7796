r"""
Which number matters for the period?
====================================

The period of stick-slip depends on belt speed, friction and stiffness. Its derivatives come with the run: each event
knows how its time moves with a parameter. Multiplied by the parameter and divided by the period,
:math:`(p/T)\,dT/dp`, they say by how many per cent the period changes for one per cent. Belt speed and stiffness
shorten it, the drop of friction lengthens it.

Each bar is a parameter: to the right it lengthens the period, to the left it shortens it.
"""

import matplotlib.pyplot as plt

import fricmb as fm

belt, mass = fm.Driven("belt", velocity={"x": 0.1}), fm.Body("mass", mass=1.0, velocity={"x": 0.1})
sole = fm.Contact("sole", mass, belt, law=fm.laws.Coulomb(mu_s=1.5, mu_k=1.0), normal_force=1.0)
scene = fm.Scene("belt", [mass, belt, fm.Spring("spring", mass, axis="x", stiffness=1.0), sole])
names = ("belt.velocity.x", "spring.stiffness", "mass.mass", "sole.normal_force", "sole.law.mu_s", "sole.law.mu_k")
sol = fm.simulate(scene, t_end=60.0, rtol=1e-10, sensitivities=names)

first, second = sol.events.of(kind="slip")[1:3]
period = second.t - first.t
slopes = {name: second.sensitivity(name) - first.sensitivity(name) for name in names}
shares = [slopes[name] * scene.parameters[name] / period for name in names]

figure, ax = plt.subplots(figsize=(6.4, 2.8), layout="constrained")
ax.barh(names, shares)
ax.axvline(0.0, color="black", linewidth=0.8)
ax.set_xlabel("change of the period in per cent for one per cent")
ax.invert_yaxis()
plt.show()

print(f"period {period:.9f}, by belt speed {slopes['belt.velocity.x']:.9f}, by mu_s {slopes['sole.law.mu_s']:.9f}")
assert abs(slopes["belt.velocity.x"] + 96.15384615384615) < 1e-7
assert abs(slopes["sole.law.mu_s"] - 19.23076923076923) < 1e-7
