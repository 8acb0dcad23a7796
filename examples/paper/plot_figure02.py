"""
Figure 2: braking, case 1
=========================

All natural frequencies equal. The source shows the rotor slow down almost linearly, while the pad's swings along x
stick and slip in the wedge below; across, one undisturbed swing.

Ours agrees but for the beginning. The source describes a first time of pure slip, until the rotor is slower than the
pad's largest swing. With the printed friction (15) and speed (10) taken literally the pad would swing with 15, so it
is caught in its very first swing.
"""

import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run

figure = FIGURES[2]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

rate = -np.polyfit(sol.t, sol.velocity("rotor.x"), 1)[0]
print(f"deceleration {rate:.5f}, friction over the rotor's mass {15 / 1000}")
first = sol.events[0]
assert first.kind == "stick"
assert abs(first.t - 0.728764) < 1e-2  # case 1 and 2 differ across only
assert [finding.agrees for finding in figure.check(sol)] == [True, True, False]
