"""
What does a law of my own do?
=============================

A friction law is one small class. This one falls with the logarithm of the slip speed, as friction of rock does. The
mass on the belt is torn off when its spring (k = 1) has reached mu_s N = 1.5, first after 1.5/0.1 = 15 of time.

On the left is the law; on the right what it does to a mass on a belt.
"""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
import sympy

import fricmb as fm


@dataclass(frozen=True, kw_only=True)
class LogWeakening(fm.FrictionLaw):
    """mu(r) = mu_s / (1 + slope log(1 + r/v_0))."""

    mu_s: float
    slope: float
    v_0: float = 0.01

    def define_coefficient(self, r):  # noqa: D102
        return self.mu_s / (1 + self.slope * sympy.log(1 + r / self.v_0))


law, r = LogWeakening(mu_s=1.5, slope=0.1), np.linspace(0.0, 0.5, 400)
sol = fm.simulate(fm.models.belt_oscillator(law=law, belt=0.1), t_end=100.0, rtol=1e-9)
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.2), layout="constrained")
left.plot(r, law.coefficient(r))
left.set(xlabel="slip speed", ylabel="coefficient of friction")
sol.plot.phase("mass.x", ax=right)
plt.show()

print(sol.events[0])
assert abs(sol.events[0].t - 15.0) < 1e-7
