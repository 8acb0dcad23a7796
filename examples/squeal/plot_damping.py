r"""
Can damping make a brake squeal?
================================

Yes, if only one of the two modes that meet is damped. Damped alike (c each) they squeal from :math:`\mu = \frac34(1 +
2c^2)` on (the roots of the model of :doc:`/gallery/squeal/plot_flutter` with :math:`s^2 + cs` for :math:`s^2`: its
stiffness has eigenvalues :math:`2 \pm i\delta`, and :math:`\delta = c\sqrt2`).

The map shows the largest growth rate over the friction and the damping of one mode; the other is damped with 0.02.
The black line is the limit of squeal. Where the first mode has hardly any damping it lies below 3/4, the limit
without damping.
"""

import numpy as np

import fricmb as fm

mass, belt = fm.Body("mass", mass=1.0, axes="xy"), fm.Driven("belt", velocity={"x": -1.0})
lining = fm.normal.Spring(axis="y", stiffness=4 / 3, preload=10.0)
scene = fm.Scene("two modes", [
    mass, belt, fm.MatrixElement("structure", ["mass.x", "mass.y"], K=[[2, 1], [1, 2 / 3]]),
    fm.Damper("cx", mass, axis="x", damping=0.1), fm.Damper("cy", mass, axis="y", damping=0.1),
    fm.Contact("sole", mass, belt, law=fm.laws.Coulomb(mu_s=2.0, mu_k=0.3), normal_force=lining),
])  # fmt: skip

found = fm.analysis.stability_map(
    scene.with_parameters({"cx.damping": 0.02}), over=("sole.law.mu_k", "cy.damping"),
    values=(np.linspace(0.4, 1.0, 16), np.linspace(0.0, 0.4, 11)),
)  # fmt: skip
fm.plot.show(fm.plot.stability(found))

(critical,) = fm.analysis.complex_eigenvalues(scene, over="sole.law.mu_k", values=[0.0, 1.2]).critical
closed = 0.75 * (1 + 2 * 0.1**2)
print(f"damped alike with 0.1: {critical.value:.15f}, closed form {closed:.15f}")
assert abs(critical.value - closed) < 1e-10
