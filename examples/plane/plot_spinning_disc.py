r"""
Which comes to rest first, sliding or spinning?
===============================================

Neither. Sliding takes friction from the spin and spinning from the slide, so whichever lags is slowed less, and a
uniform disc ends both at one instant, with :math:`v/(R\omega) = 0.653` whatever its start: Z. Farkas, G. Bartels, T.
Unger, D. E. Wolf, Phys. Rev. Lett. 90 (2003) 248302.

Each line is a disc with another start, from the upper right to rest at the origin. All end along the dashed line of
the published ratio.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

disc = fm.Body("disc", mass=1.0, axes="xyz")
half = fm.MatrixElement("spin", ["disc.z"], M=[[-0.5]])  # z is R times the angle, its mass m R^2/2 over R^2
ice = fm.Contact("ice", disc, law=fm.laws.Contensou(mu=1.0, v_reg=1e-12), normal_force=1.0, axes="xyz")
scene = fm.Scene("disc", [disc, half, ice])

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
for v, u in ((1.0, 0.3), (0.6, 0.8), (0.2, 1.0)):
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-9, initial={"velocity": {"disc.x": v, "disc.z": u}})
    slide, spin = sol.velocity("disc.x"), sol.velocity("disc.z")
    moving = np.hypot(slide, spin) > 1e-8
    ax.plot(slide[moving], spin[moving], ".-", markersize=3)
    ratio = slide[moving][-1] / spin[moving][-1]
    print(f"from {v / u:.3f} to {ratio:.6f}; published: 0.653")
    assert abs(ratio - 0.653) < 0.002
s = np.array([0.0, 0.8])
ax.plot(0.653 * s, s, "k--", linewidth=0.8, label="$v = 0.653\\,R\\omega$")
ax.set(xlabel="sliding $v$", ylabel="spinning $R\\omega$")
ax.legend()
plt.show()
