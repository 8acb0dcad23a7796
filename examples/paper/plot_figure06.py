"""
Figure 6: case 3
================

Both frequencies across above 1. Braking along x is unaffected; across, the pad is kicked again, with more structure.
"""

import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run

figure = FIGURES[6]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

t = np.linspace(0.0, 700.0, 701)
difference = np.abs(sol.at(t).velocity("rotor.x") - run("1").at(t).velocity("rotor.x")).max()
print(f"the rotor's speed differs from case 1 by at most {difference:.1e}")
assert difference < 1e-4
