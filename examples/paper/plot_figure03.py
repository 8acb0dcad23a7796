"""
Figure 3: the first swings across, case 1
=========================================

Velocities along y at the beginning: pad and rotor together, stick-slip barely to be seen. Ours agrees once the pad
has been caught, within its first swing.
"""

import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run

figure = FIGURES[3]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

late = sol.at(np.linspace(8.0, 30.0, 2201))
apart = np.abs(late.velocity("pad.y") - late.velocity("rotor.y")).max()
print(f"at most {apart:.2e} apart after 8, the rotor's swing being 0.01")
assert apart < 0.05 * 0.01
