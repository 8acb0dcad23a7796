r"""
How loud does a wheel squeal in a curve?
========================================

The wheel creeps sideways at :math:`v`, and friction :math:`\mu_s - a v + b v^3` is least at :math:`v_m`. Over a period
of :math:`A \cos\omega t` it gives no energy where :math:`a = b\,(3 v^2 + \tfrac34 A^2)`; with :math:`a = 3 b v_m^2`
that is :math:`A = 2\sqrt{v_m^2 - v^2}` (averaging as in J. J. Thomsen and A. Fidlin, Int. J. Non-Linear Mech. 38 (2003)
389-403), while the wheel does not stick, :math:`A < v`.

The line is the formula, the dots are runs: the faster the wheel creeps, the smaller the squeal, up to the speed of
least friction, where it ends.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

v_m, omega = 0.05, 2 * np.pi * 1000.0
law = fm.laws.Cubic(mu_s=0.4, mu_m=0.3, v_m=v_m)
wheel = fm.ModalBody("wheel", frequencies=[omega], damping_ratios=0.0, masses=[50.0], shapes={"tread": [[1.0]]})
rail = fm.Driven("rail", velocity={"x": 0.9 * v_m})
tread = fm.Contact("tread", wheel.point("tread"), rail, law=law, normal_force=5e3)
scene = fm.Scene("wheel", [wheel, rail, tread])


def loudness(v):
    """Amplitude of the velocity of the wheel, once it has settled."""
    slow = scene.with_parameters({"rail.velocity.x": v})
    sol = fm.simulate(slow, t_end=1.5, rtol=1e-6, t_eval=np.linspace(1.49, 1.5, 2001))
    return np.abs(sol.velocity("wheel.tread.x")).max()


speeds = v_m * np.linspace(0.9, 0.98, 5)
found, closed = np.array([loudness(v) for v in speeds]), 2 * np.sqrt(v_m**2 - speeds**2)
figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(speeds / v_m, closed / v_m, "-", speeds / v_m, found / v_m, "o")
ax.set(xlabel="speed of creep / $v_m$", ylabel="amplitude of the wheel / $v_m$")
plt.show()
print(f"measured over closed form: {np.round(found / closed, 5)}")
assert np.abs(found / closed - 1).max() < 1e-3
