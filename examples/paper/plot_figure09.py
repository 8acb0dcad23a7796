r"""
Figure 9: case 4
================

Rotor below pad across. Peaks grow up to :math:`\Omega_2`, fall after, and fall faster past :math:`\Omega_1`. Ours
agrees.
"""

import numpy as np

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run, slope, spikes

figure = FIGURES[9]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

found = spikes(sol)
rising, falling, steep = (slope(*found.part(a, b)) for a, b in ((0.5, 7.3), (6.9, 12.5), (11.9, 16.5)))
print(f"{rising:+.1f}, {falling:+.1f}, {steep:+.1f} dB per unit of frequency")
assert rising > 1 > 0 > -3 > falling > steep + 2
assert np.abs(found.peaks.omega - 12.533).min() > 0.3  # none at Omega1
