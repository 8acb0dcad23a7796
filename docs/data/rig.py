"""A made-up measurement on a motor, as two loggers would write it.

The rotor turns under a torque that sweeps and is held for moments; its bearing rubs (Stribeck's curve, other friction
to the left than to the right).  The motion is integrated with fixed small steps and a case for standstill, in plain
Python and numpy: nothing here knows of fricmb.  What the loggers write is not what there is:

* torque: an offset, a slow drift and noise, 200 samples a second by the clock of the drive;
* angle: whole steps of an encoder, now and then a wrong word, 250 samples a second by a clock of its own, which was
  started 0.18 s before the drive's and is 120 parts in a million fast.

Run it to write ``rig_drive.csv`` and ``rig_encoder.csv`` beside it.
"""

from pathlib import Path

import numpy as np

INERTIA, VISCOUS, KINETIC, STATIC, SPEED = 0.013, 0.021, 0.31, 0.44, 0.6
LEFT = 0.06  # more friction to the left, less to the right, by so much
END, STEP = 12.0, 2e-5
LINES = 4096


def torque(t):
    """N m: swings that grow quicker, less than friction in between."""
    return 0.95 * np.sin(2 * np.pi * (0.35 * t + 0.045 * t**2)) + 0.35 * np.sin(2 * np.pi * 0.21 * t + 1.0)


def friction(v):
    """N m against the motion, at speed v."""
    size = KINETIC + (STATIC - KINETIC) * np.exp(-((abs(v) / SPEED) ** 2))
    return np.sign(v) * size + VISCOUS * v - LEFT


def motion():
    """Times, angles."""
    n = round(END / STEP)
    t, angle = STEP * np.arange(n + 1), np.zeros(n + 1)
    load = torque(t)
    x, v = 0.0, 0.0
    for i in range(n):
        if v == 0.0:  # at rest until the torque is more than friction holds
            pull = load[i] + LEFT
            if abs(pull) > STATIC:
                v = np.sign(pull) * STEP * (abs(pull) - STATIC) / INERTIA
        else:
            # two stages of Heun; through zero means standstill, and what happens there is looked at anew
            a = (load[i] - friction(v)) / INERTIA
            w = v + STEP * a
            b = (load[i + 1] - friction(w if w * v > 0 else v)) / INERTIA
            new = v + 0.5 * STEP * (a + b)
            x += 0.5 * STEP * (v + new)
            v = new if new * v > 0 else 0.0
        angle[i + 1] = x
    return t, angle


def main():
    rng = np.random.default_rng(20)
    t, angle = motion()
    drive = np.arange(0.0, END - 0.2, 0.005)
    measured = torque(drive) + 0.08 + 0.004 * drive + 0.01 * rng.standard_normal(drive.size)
    by_drive = np.column_stack([drive, measured])
    clock = np.arange(0.0, END - 0.05, 0.004)  # what the encoder's clock shows
    true = clock / (1 + 120e-6) - 0.18
    steps = np.floor(np.interp(true, t, angle) * LINES / (2 * np.pi) + 0.5)
    wrong = rng.choice(clock.size, 12, replace=False)
    steps[wrong] += rng.choice([-1, 1], 12) * 2.0 ** rng.integers(9, 12, 12)
    folder = Path(__file__).parent
    np.savetxt(folder / "rig_drive.csv", by_drive, "%.3f,%.4f", header="t [s],torque [N m]", comments="")
    by_encoder = np.column_stack([clock, steps])
    np.savetxt(folder / "rig_encoder.csv", by_encoder, "%.3f,%d", header="t [s],steps", comments="")


if __name__ == "__main__":
    main()
