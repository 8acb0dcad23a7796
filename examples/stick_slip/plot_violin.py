"""
What does a bow do to a string?
===============================

It carries the string along and lets it fly back once in each period, 2 L/c, by which a kink runs round the string. The
string slips for that share of the period by which the bow divides it: H. Helmholtz, On the Sensations of Tone (1863).

The string moves with the bow for most of each period and flies back in the rest, about as fast as Helmholtz's
motion (dashed).
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

beta, n = 0.13, np.arange(1, 41)  # where the bow is, as a share of the length; length, speed of waves and mass are 1
string = fm.ModalBody(
    "string", frequencies=n * np.pi, damping_ratios=5e-4 * np.sqrt(n), masses=np.full(40, 0.5),
    shapes={"bow": [np.sin(n * np.pi * beta)]},
    velocity={f"mode{i}": 0.1 / beta * 2 * (-1) ** (i + 1) / (i * np.pi) for i in n},  # straight, turning about its end
)  # fmt: skip
bow = fm.Driven("bow", velocity={"x": 0.1})
law = fm.laws.HyperbolicStribeck(mu_s=0.8, mu_k=0.2, delta=50.0)
hair = fm.Contact("hair", string.point("bow"), bow, law=law, normal_force=1.0)
sol = fm.simulate(fm.Scene("string", [string, bow, hair]), t_end=40.0, rtol=1e-5)

late = sol.at(np.linspace(30.0, 40.0, 4001))
figure, ax = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
ax.plot(late.t / 2.0, late.velocity("string.bow.x"), linewidth=1.0)
ax.axhline(-0.1 * (1 - beta) / beta, color="0.6", linestyle="--", label="Helmholtz: slips back at $v(1-\\beta)/\\beta$")
ax.set(xlabel="time in periods of the free string", ylabel="speed of the string under the bow")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
plt.show()

slips = sol.events.of(kind="slip").t
period, share = slips[-1] - slips[-2], np.mean(late.mode("hair") == 1)
print(f"period {period:.4f}, of the free string 2; slips for {share:.3f} of it, bowed at {beta} (40 modes)")
assert abs(period / 2.0 - 1) < 0.005
assert abs(share - beta) < 0.02
