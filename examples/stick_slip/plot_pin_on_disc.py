r"""
What does the sawtooth of a pin on a disc tell?
===============================================

The force rises to :math:`\mu_s N`, where the pin breaks loose. It swings about :math:`\mu_k N` and is caught again as
far on the other side (without damping the swing is its own mirror image): at :math:`(2\mu_k - \mu_s) N`. So the middle
of the tooth is the friction of slip; its mean over time is more, for the pin sticks on the way up.

The dashed lines are both coefficients. The teeth rise to the upper one; their middle is the lower one.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

mu_s, mu_k, N, k = 0.5, 0.35, 10.0, 2e4
pin, disc = fm.Body("pin", mass=0.05), fm.Driven("disc", velocity={"x": 2e-3})
scene = fm.Scene("pin on disc", [
    pin, disc, fm.Spring("arm", pin, axis="x", stiffness=k),
    fm.Contact("spot", pin, disc, law=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), normal_force=N),
])  # fmt: skip
sol = fm.simulate(scene, t_end=0.5, rtol=1e-9)

figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(sol.t, k * sol["pin.x"] / N)
for mu, name in ((mu_s, "$\\mu_s$"), (mu_k, "$\\mu_k$")):
    ax.axhline(mu, color="0.6", linewidth=0.8, linestyle="--")
    ax.annotate(name, (0.0, mu + 0.008))
ax.set(xlabel="time (s)", ylabel="force of the arm / N", ylim=(-0.02, 0.56))
plt.show()

loose, caught = (k * sol.at(sol.events.of(kind=kind).t)["pin.x"] / N for kind in ("slip", "stick"))
print(f"breaks loose at {loose[-1]:.9f}, caught at {caught[-1]:.9f}, middle {0.5 * (loose[-1] + caught[-1]):.9f}")
assert np.abs(loose - mu_s).max() < 1e-8
assert np.abs(caught[1:] - (2 * mu_k - mu_s)).max() < 1e-8
