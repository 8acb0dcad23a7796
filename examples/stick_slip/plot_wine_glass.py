r"""
How far does the rim of a singing glass swing?
==============================================

The finger drives the rim until the rim keeps up with it: sticking to it, it cannot be faster. So the swing is
:math:`v/\omega` whatever the law of friction, louder for a quicker finger; and the note is that of the glass.

The rim starts from rest, grows within some periods, and keeps the size of the formula (dashed); on the right its last
10 ms.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

pitch, v = 660.0, 0.2
glass = fm.ModalBody(
    "glass", frequencies=[2 * np.pi * pitch], damping_ratios=3e-4, masses=[0.02], shapes={"rim": [[1.0]]}
)
finger = fm.Driven("finger", velocity={"x": v})
law = fm.laws.Stribeck(mu_s=0.4, mu_k=0.3, v_s=0.3)
touch = fm.Contact("touch", glass.point("rim"), finger, law=law, normal_force=2.0)
sol = fm.simulate(fm.Scene("glass", [glass, finger, touch]), t_end=0.6, rtol=1e-7)

figure, axes = plt.subplots(1, 2, figsize=(8.0, 3.2), sharey=True, width_ratios=(2, 1), layout="constrained")
for ax, part in zip(axes, (np.linspace(0.0, 0.6, 30001), np.linspace(0.59, 0.6, 2001)), strict=True):
    ax.plot(1e3 * part, 1e6 * sol.at(part)["glass.rim.x"], linewidth=0.5)
    ax.plot(1e3 * part[[0, -1]], 1e6 * v / (2 * np.pi * pitch) * np.array([[1, -1], [1, -1]]), "--", color="tab:orange")
    ax.set_xlabel("time (ms)")
axes[0].set(ylabel="rim (micrometres)", title="dashed: $v/\\omega$")
plt.show()

late = sol.at(np.linspace(0.5, 0.6, 20001))
swing = 0.5 * np.ptp(late["glass.rim.x"])
turns = late.t[1:][np.diff(np.sign(late.velocity("glass.rim.x"))) > 0]
note = (len(turns) - 1) / (turns[-1] - turns[0])
print(f"swing {swing:.4e} m, v/omega {v / (2 * np.pi * pitch):.4e} m; note {note:.2f} Hz, glass {pitch} Hz")
assert abs(swing * 2 * np.pi * pitch / v - 1) < 0.01
assert abs(note / pitch - 1) < 1e-3
