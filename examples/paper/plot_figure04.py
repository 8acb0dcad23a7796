r"""
Figure 4: kicks across, case 2
==============================

The rotor soft across, the pad stiff. Braking along x is that of case 1; across, the pad is kicked in a regular train,
and the spectrum of its motion is a row of spikes one apart (the pad's frequency *along* is 1). They fall faster past
:math:`\Omega_1`, where there is no peak at all.

Ours agrees. A shift by :math:`\Omega_2 = 0.016`, which the source supposes and calls negligible, cannot be seen at
this order: the peaks scatter by as much.
"""

import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run, slope, spikes

figure = FIGURES[4]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

found = spikes(sol)
places, powers = found.part(0.5, 16.5)
spacing = np.polyfit(np.round(places), places, 1)[0]
print(f"{len(places)} spikes, {spacing:.4f} apart")
assert len(places) == 16
assert abs(spacing - 1) < 0.005
assert np.abs(places - 12.533).min() > 0.4  # none at Omega1
assert slope(*found.part(12.0, 16.5)) < slope(*found.part(0.5, 12.5)) < 0
