r"""
How fast does a robot on bristles creep along?
==============================================

A weight swings in a robot that stands on bristles: friction against their lie, :math:`F_b`, is three times that with
it, :math:`F_f`. Where the drive :math:`P\sin\omega t` never lets it stick, friction gives it no momentum over a
period T, so it slips forward for :math:`\tau = T F_b/(F_f + F_b)`, and the velocity is 0 at both ends of that. The
middle of that time is at the phase :math:`\varphi` with :math:`2P\sin\varphi\sin(\omega\tau/2) = F_f\,\omega\tau`,
and the distance covered in a period follows from two integrals.

Above, the position, and the straight line of the mean; below, the friction force, whose size differs each way.
"""

import math

import matplotlib.pyplot as plt
import sympy

import fricmb as fm

m, N, w, P, forward, back = 2.0, 10.0, 5.0, 60.0, 0.2, 0.6
T = 2 * math.pi / w
tau = T * back / (forward + back)
middle = math.pi - math.asin(forward * N * tau * w / (2 * P * math.sin(w * tau / 2)))
way, phase = 0.0, middle - w * tau / 2
for length, pull, start in ((tau, forward * N, phase), (T - tau, -back * N, phase + w * tau)):
    swing = length * math.cos(start) - (math.sin(start + w * length) - math.sin(start)) / w
    way += (P / w * swing - pull * length**2 / 2) / m

robot = fm.Body("robot", mass=m)
feet = fm.Contact("feet", robot, law=fm.laws.Offset.by_sense(mu_s=(forward, back)), normal_force=N)
drive = fm.Force("drive", robot, axis="x", value=P * sympy.sin(w * fm.t + phase))
sol = fm.simulate(fm.Scene("robot", [robot, feet, drive]), t_end=6 * T, rtol=1e-9)

figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.4, 4.4), sharex=True, layout="constrained")
sol.plot.positions(["robot.x"], ax=top)
top.plot([0, 6 * T], [0, 6 * way], "k--", lw=0.8)
sol.plot.force("feet", ax=bottom)
plt.show()

print(f"way of a period {sol['robot.x'][-1] / 6:.12f}, closed form {way:.12f}")
assert abs(sol["robot.x"][-1] / (6 * way) - 1) < 1e-8
