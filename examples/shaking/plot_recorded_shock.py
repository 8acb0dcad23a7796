r"""
How far does a recorded shock move a box?
=========================================

A box on shaken ground slips while :math:`|a_g| > \mu g` and until its speed is that of the ground again (Newmark's
sliding block). The record is a measured series, 200 values a second; a time-stepping loop of five lines goes beside it.
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

mu_g = 0.25 * 9.81
rng, t = np.random.default_rng(7), np.arange(0.0, 6.0, 0.005)  # stands for an accelerometer: noise from 1 to 8 Hz
waves = (rng.normal() * np.sin(2 * np.pi * rng.uniform(1.0, 8.0) * t + rng.uniform(0.0, 6.28)) for _ in range(40))
record = fm.Signal(t, 0.7 * sum(waves) * np.exp(-(((t - 2.5) / 1.1) ** 2)), name="a")

ground, box = fm.Driven("ground", velocity={"x": record.integral}), fm.Body("box", mass=1.0)
foot = fm.Contact("foot", box, ground, law=fm.laws.Coulomb(mu_s=0.25), normal_force=9.81)
sol = fm.simulate(fm.Scene("recorded shock", [ground, box, foot]), t_end=t[-1], rtol=1e-9)
slip = sol["box.x"] - sol["ground.x"]

figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.4, 4.4), sharex=True, layout="constrained")
top.plot(record.t, record.y, lw=0.8)
top.hlines([-mu_g, mu_g], 0, 6, ls="--", lw=0.8, color="0.5")
top.set_ylabel("ground (m/s²)")
bottom.plot(sol.t, 1e3 * slip)
bottom.set(ylabel="slip (mm)", xlabel="time (s)")
plt.show()

dt, w, x = 1e-5, 0.0, 0.0
for a in np.interp(np.arange(0.5 * dt, t[-1], dt), t, record.y).tolist():
    free = w - a * dt
    w = max(abs(free) - mu_g * dt, 0.0) * (1.0 if free > 0.0 else -1.0)
    x += w * dt
print(f"slip {1e3 * slip[-1]:.4f} mm, by the loop {1e3 * x:.4f} mm, {len(sol.events)} transitions")
assert abs(slip[-1] / x - 1) < 1e-3
