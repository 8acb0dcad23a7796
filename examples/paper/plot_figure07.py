r"""
Figure 7: shifted spikes, case 3
================================

Peaks one apart, shifted by :math:`\Omega_2 = 7.07`, so that they stand at k + 0.07; they grow from :math:`\Omega_1`
to :math:`\Omega_2` and fall after, and there is none at :math:`\Omega_1`. Ours agrees. The last, the highest peak is
the common vibration after the rotor has stopped.
"""

import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run, shift_of, slope, spikes

figure = FIGURES[7]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

found = spikes(sol)
places, _ = found.part(1.5, 16.5)
shift, scatter = shift_of(places)
print(f"shifted by {shift:.3f}, scatter {scatter:.3f}; Omega2 = 7.071")
assert abs(shift - 0.071) < 0.02
assert np.abs(places - 4.472).min() > 0.3  # none at Omega1
assert slope(*found.part(4.0, 7.3)) > 0 > slope(*found.part(6.9, 16.5))
