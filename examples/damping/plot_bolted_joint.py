r"""
How does the damping of a bolted joint grow with its load?
==========================================================

With the cube of the amplitude: a harder load makes more of the joint slip, and slip farther. An Iwan joint of n equal
springs :math:`k_0`, whose sliders' limits are spread evenly up to :math:`l`, loses :math:`4 l_i (a - l_i/k_0)` in
each that slips; for many that adds up to :math:`\frac23 n k_0^2 a^3/l` (W. D. Iwan, J. Appl. Mech. 33 (1966)
893-900).

On the left are the loops of friction over displacement for five amplitudes; the area of a loop is the loss in a
period. On the right the dots are these losses over the amplitude, on logarithmic axes; the line is the formula.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm

n, k0, top = 20, 1.0, 1.0
limits = top * (np.arange(n) + 0.5) / n
law = fm.laws.Iwan(stiffness=(k0,) * n, limits=tuple(limits), corner=1e-3)
plate = fm.Body("plate", mass=1e9)  # as good as fixed
shaker = fm.Driven("shaker", position={"x": fm.parameter("a", 1.0) * sympy.sin(2 * sympy.pi * fm.t)})
scene = fm.Scene("joint", [plate, shaker, fm.Contact("bolt", plate, shaker, law=law, normal_force=1.0)])
amplitudes, loss = np.geomspace(0.2, 0.9, 5), []
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.2), layout="constrained")
for a in amplitudes:
    sol = fm.simulate(scene.with_parameters({"a": a}), t_end=2.0, rtol=1e-5, t_eval=np.linspace(1.0, 2.0, 401))
    loss.append(sol.energy.friction_loss[-1] - sol.energy.friction_loss[0])
    left.plot(sol["shaker.x"], sol.force("bolt")[0], linewidth=1.0)
closed = np.array([np.sum(4 * limits * np.maximum(a - limits / k0, 0.0)) for a in amplitudes])

left.set(xlabel="displacement", ylabel="friction force")
right.loglog(amplitudes, 2 / 3 * n * k0**2 * amplitudes**3 / top, "-", amplitudes, loss, "o")
right.set(xlabel="amplitude", ylabel="loss a period", title="slope 3")
right.set_xticks([0.2, 0.4, 0.8], ["0.2", "0.4", "0.8"])
right.minorticks_off()
plt.show()
print(f"loss over that of the sliders: {np.round(loss / closed, 4)}")
assert np.abs(loss / closed - 1).max() < 0.01
