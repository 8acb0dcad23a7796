r"""
Figure 10: the shift close up, case 4
=====================================

A part of the previous figure: the peaks stand at k + 0.07, :math:`\Omega_2 = 7.07`. Ours agrees.
"""


import fricmb as fm
from fricmb.models.brake_paper import FIGURES, run, shift_of, spikes

figure = FIGURES[10]
sol = run(figure.case)
fm.plot.show(figure.draw(sol))

# %%
# Statement by statement, and the numbers that this page stands for.

for finding in figure.check(sol):
    print(finding)

shift, scatter = shift_of(spikes(sol).part(4.0, 12.5)[0])
print(f"shifted by {shift:.3f}, scatter {scatter:.3f}")
assert abs(shift - 0.071) < 0.015
