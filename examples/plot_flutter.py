"""
Flutter of two modes
====================

Steady sliding on an elastic lining, with friction that does not depend on speed: two modes draw near as friction rises,
meet, and one of them grows.  The model is that of N. Hoffmann, M. Fischer, R. Allgaier, L. Gaul, Mech. Res. Commun. 29
(2002) 197-205.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

# %%
# A mass with a full stiffness matrix, of which 4/3 towards the belt is the lining: it carries the normal force.

mass, belt = fm.Body("mass", mass=1.0, axes="xy"), fm.Driven("belt", velocity={"x": -1.0})
lining = fm.normal.Spring(axis="y", stiffness=4 / 3, preload=10.0)
scene = fm.Scene(
    "two modes",
    [
        mass,
        belt,
        fm.MatrixElement("structure", ["mass.x", "mass.y"], K=[[2, 1], [1, 2 / 3]]),
        fm.Damper("cx", mass, axis="x", damping=0.0),
        fm.Damper("cy", mass, axis="y", damping=0.0),
        fm.Contact("sole", mass, belt, law=fm.laws.Coulomb(mu_s=2.0, mu_k=0.3), normal_force=lining),
    ],
)

# %%
# Modes over the coefficient of friction, each followed by continuity.

modes = fm.analysis.complex_eigenvalues(scene, over="sole.law.mu_k", values=np.linspace(0.0, 1.2, 61))
print(modes)
fm.plot.eigenvalues(modes)
plt.show()

# %%
# A little damping in one of two modes can make things worse, which is known of flutter: a map over friction and the
# damping towards the belt, the other damping being small.

damped = scene.with_parameters({"cx.damping": 0.02})
found = fm.analysis.stability_map(
    damped, over=("sole.law.mu_k", "cy.damping"), values=(np.linspace(0.4, 1.0, 16), np.linspace(0.0, 0.4, 11))
)
fm.plot.stability(found)
plt.show()

# %%
# The two modes meet where 1 - 4 mu/3 = 0; with equal damping c they grow from 0.75 (1 + 2 c^2) on.

(critical,) = modes.critical
print(f"critical friction {critical.value:.15f}, angular frequency {critical.frequency:.12f}")
assert abs(critical.value - 0.75) < 1e-12
assert abs(critical.frequency - np.sqrt(2)) < 1e-9

c = 0.1
equal = scene.with_parameters({"cx.damping": c, "cy.damping": c})
(critical,) = fm.analysis.complex_eigenvalues(equal, over="sole.law.mu_k", values=[0.0, 1.2]).critical
print(f"with damping {c}: {critical.value:.15f}, closed form {0.75 * (1 + 2 * c**2):.15f}")
assert abs(critical.value - 0.75 * (1 + 2 * c**2)) < 1e-10
