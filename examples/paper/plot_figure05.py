r"""
Figure 5: one kick after the other, case 2
==========================================

A few kicks of the previous figure close up, with a small decaying oscillation at a higher frequency after each. Ours
agrees: it rings at :math:`\Omega_1`, and dies although nothing damps it: in quick slip, friction across is
:math:`-\mu N \dot y/|\dot x|`, that of a dashpot.
"""

import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run, valleys

figure = FIGURES[5]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

kicks = valleys(sol)
steps = np.diff(kicks.begin[kicks.begin < 600.0])
print(f"{steps.mean():.4f} between kicks, 2 pi = {2 * np.pi:.4f}")
assert abs(steps.mean() - 2 * np.pi) < 2e-3
assert all(finding.agrees for finding in figure.check(sol))
