r"""
At which friction does a brake squeal?
======================================

On an elastic lining two modes draw near as friction rises, meet and one of them grows, though friction does not depend
on speed: N. Hoffmann, M. Fischer, R. Allgaier, L. Gaul, Mech. Res. Commun. 29 (2002) 197-205. With their stiffnesses
:math:`(2 - \omega^2)^2 = 1 - 4\mu/3`: the modes meet at :math:`\mu = 3/4` and :math:`\omega = \sqrt2`.

The picture shows the two frequencies above, which meet at the critical friction, and the growth rates below, which
part there.
"""

import numpy as np

import fricmb as fm

mass, belt = fm.Body("mass", mass=1.0, axes="xy"), fm.Driven("belt", velocity={"x": -1.0})
lining = fm.normal.Spring(axis="y", stiffness=4 / 3, preload=10.0)
scene = fm.Scene("two modes", [
    mass, belt, fm.MatrixElement("structure", ["mass.x", "mass.y"], K=[[2, 1], [1, 2 / 3]]),
    fm.Contact("sole", mass, belt, law=fm.laws.Coulomb(mu_s=2.0, mu_k=0.3), normal_force=lining),
])  # fmt: skip
modes = fm.analysis.complex_eigenvalues(scene, over="sole.law.mu_k", values=np.linspace(0.0, 1.2, 61))
fm.plot.show(fm.plot.eigenvalues(modes))

(critical,) = modes.critical
print(f"critical friction {critical.value:.15f}, angular frequency {critical.frequency:.12f}")
assert abs(critical.value - 0.75) < 1e-12
assert abs(critical.frequency - np.sqrt(2)) < 1e-9
