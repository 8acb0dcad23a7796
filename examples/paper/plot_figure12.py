"""
Figure 12: how friction turns, case 2
=====================================

The angle of the friction force against the direction of braking peaks in every valley of the slip along x. The source
finds peaks below 1 degree that lag slightly behind the valleys, before and after the first stick.

After a valley that reaches stick ours agrees: the angle peaks 0.18 after the stick ends, in every single one. The
first swings turn by more than 1 degree (2.1). Before the first stick, in a run that has such a time, ours agrees in
part: the angle lags where the slip falls below 0.6, and where it stays larger it peaks with the valley, or 0.005
before it.
"""

import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run, valleys

figure = FIGURES[12]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

kicks = valleys(sol)
swings = kicks.sticks & (kicks.begin < 600.0)
shown = swings & (kicks.begin > 50.0) & (kicks.begin < 80.0)
print(f"lag {kicks.lag[shown].mean():.3f} in the stretch shown; at least {kicks.lag[swings].min():.3f} up to 600")
assert (kicks.lag[swings] > 0.17).all()
assert abs(kicks.lag[shown].mean() - 0.182) < 0.002
assert np.abs(kicks.angle[shown]).max() < 1
