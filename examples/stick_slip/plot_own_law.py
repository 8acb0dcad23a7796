"""
A law of your own
=================

A friction law is one small class.  Here a coefficient that falls with the logarithm of the slip speed, as
rate-dependent friction of rock does, on the mass on a belt.
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


law = LogWeakening(mu_s=1.5, slope=0.1)

# %%
# Before it runs, look at it.  The derivative comes from the same definition.

r = np.linspace(0.0, 0.5, 400)
figure, ax = plt.subplots(figsize=(6, 3.2), layout="constrained")
ax.plot(r, law.coefficient(r))
ax.set_xlabel("slip speed")
ax.set_ylabel("coefficient of friction")
ax.grid(True, linewidth=0.4, alpha=0.5)
plt.show()

# %%

sol = fm.simulate(fm.models.belt_oscillator(law=law), t_end=100.0, rtol=1e-9)
figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
sol.plot.phase("mass.x", ax=ax)
plt.show()

# %%
# It is torn off when the spring has reached mu_s N: at x = 1.5, for the first time at 15.

first = sol.events[0]
print(first)
assert first.kind == "slip"
assert abs(first.t - 15.0) < 1e-7
assert abs(sol.energy.residual).max() < 1e-6
