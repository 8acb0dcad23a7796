"""What the source says about each figure, and what we find."""

from __future__ import annotations

import numpy as np

import fricmb as fm
from fricmb.models.brake4dof import CASES, brake4dof
from fricmb.models.brake_paper._measures import (
    Finding,
    apart,
    shifted,
    silent,
    spikes,
    steeper,
    trend,
)
from fricmb.models.brake_paper._runs import run
from fricmb.models.brake_paper._valleys import valleys

#: The stretch that is looked at close up in figures 5 and 12.
CLOSE = (50.0, 80.0)


def _braking(sol: fm.Solution) -> tuple[float, float]:
    """Mean deceleration of the rotor until it has stopped, and the largest distance from a straight line."""
    t = np.linspace(0.0, 650.0, 2001)
    speed = sol.at(t).velocity("rotor.x")
    rate, start = np.polyfit(t, speed, 1)
    return float(-rate), float(np.abs(speed - start - rate * t).max())


def figure2(sol: fm.Solution) -> list[Finding]:
    """Near-linear braking, the stick-slip wedge, y barely disturbed."""
    rate, bend = _braking(sol)
    sticks = sol.events.of(kind="stick").t
    late = sol.at(np.linspace(20.0, 640.0, 40001))
    ratio = np.abs(late.velocity("pad.x")).max() / late.velocity("rotor.x")[0]
    return [
        Finding(
            statement="the rotor is braked almost linearly",
            found=f"mean deceleration {rate:.5f} (muN/R = 0.015); at most {bend:.3f} of 10 off a straight line",
            agrees=bend < 0.2,
        ),
        Finding(
            statement="the pad's swings fill a wedge whose edge is the rotor's speed",
            found=f"largest pad speed after 20 over the rotor's there: {ratio:.4f}",
            agrees=abs(ratio - 1) < 0.02,
        ),
        Finding(
            statement="slip goes on first, until the rotor is slower than the pad's saturated swing",
            found=f"first stick at {sticks[0]:.3f}: with 15 and 10 taken literally the pad would outrun the rotor",
            agrees=bool(sticks[0] > 20.0),
        ),
    ]


def figure3(sol: fm.Solution) -> list[Finding]:
    """Stick-slip hardly shows along y."""
    early = sol.at(np.linspace(0.0, 30.0, 30001))
    pad, rotor = early.velocity("pad.y"), early.velocity("rotor.y")
    difference = np.abs(pad - rotor) / np.abs(rotor).max()
    caught, later = difference[(early.t > 1.0) & (early.t < 8.0)].max(), difference[early.t > 8.0].max()
    return [
        Finding(
            statement="both move closely together along y",
            found=f"at most {100 * later:.1f} % of the rotor's swing apart after 8; {100 * caught:.0f} % in the first"
            " swing, in which the pad is caught",
            agrees=bool(later < 0.05),
        )
    ]


def figure4(sol: fm.Solution) -> list[Finding]:
    """Spikes one apart, none at Omega1, falling faster past it."""
    found = spikes(sol)
    Omega1, Omega2, _ = CASES["2"]
    places, _ = found.part(0.5, 16.5)
    rate, rate1 = _braking(sol)[0], _braking(run("1"))[0]
    return [
        Finding(
            statement="braking as in case 1",
            found=f"mean decelerations {rate:.6f} and {rate1:.6f}",
            agrees=abs(rate / rate1 - 1) < 1e-3,
        ),
        apart(places),
        silent(found, Omega1),
        trend(found, 0.5, Omega1, rising=False),
        steeper(found, 0.5, Omega1, 16.5),
        shifted(places, Omega2),
    ]


def figure5(sol: fm.Solution) -> list[Finding]:
    """The ringing between two kicks."""
    kicks = valleys(sol)
    inside = (kicks.begin > CLOSE[0]) & (kicks.begin < CLOSE[1])
    steps = np.diff(kicks.begin[inside])
    begin = float(kicks.end[inside][0]) + 1.0
    ring = sol.at(np.linspace(begin, begin + 4.5, 45001))
    slip = -ring.relative_velocity("lining")[0]
    signal = ring["pad.y"] - np.convolve(ring["pad.y"], np.ones(5013) / 5013, mode="same")
    part = slice(6000, 39000)
    zeros = ring.t[part][1:][np.diff(np.sign(signal[part])) != 0]
    frequency = np.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0])
    return [
        Finding(
            statement="kicks come periodically, once in each swing of the pad",
            found=f"{steps.mean():.4f} apart (2 pi = 6.2832)",
            agrees=abs(steps.mean() / (2 * np.pi) - 1) < 1e-3,
        ),
        Finding(
            statement="between them a smaller decaying oscillation at a higher frequency",
            found=f"it rings at {frequency:.2f} (Omega1 = 12.53) while the slip is up to {slip.max():.1f}",
            agrees=abs(frequency / CASES["2"][0] - 1) < 0.03,
        ),
    ]


def figure6(sol: fm.Solution) -> list[Finding]:
    """Braking does not depend on what happens across."""
    t = np.linspace(0.0, 700.0, 7001)
    apart_by = np.abs(sol.at(t).velocity("rotor.x") - run("1").at(t).velocity("rotor.x")).max()
    return [
        Finding(
            statement="velocities along x are those of case 1",
            found=f"the rotor's differ by at most {apart_by:.1e} of 10",
            agrees=bool(apart_by < 0.02),
        )
    ]


def figure7(sol: fm.Solution) -> list[Finding]:
    """Case 3."""
    found = spikes(sol)
    Omega1, Omega2, _ = CASES["3"]
    places, _ = found.part(1.5, 16.5)
    return [
        apart(places),
        shifted(places, Omega2),
        silent(found, Omega1),
        trend(found, Omega1 - 0.45, Omega2 + 0.2, rising=True),
        trend(found, Omega2 - 0.2, 16.5, rising=False),
    ]


def figure8(sol: fm.Solution) -> list[Finding]:
    """Case 3 with other frequencies; below 11 the peaks are too weak for the estimate."""
    found = spikes(sol)
    Omega1, Omega2, _ = CASES["3b"]
    places, _ = found.part(11.0, 22.0)
    return [
        apart(places),
        shifted(places, Omega2),
        silent(found, Omega1),
        trend(found, Omega1, Omega2 + 0.2, rising=True),
        trend(found, Omega2 - 0.2, 22.0, rising=False),
    ]


def figure9(sol: fm.Solution) -> list[Finding]:
    """Case 4."""
    found = spikes(sol)
    Omega1, Omega2, _ = CASES["4"]
    return [
        apart(found.part(0.5, 16.5)[0]),
        silent(found, Omega1),
        trend(found, 0.5, Omega2 + 0.2, rising=True),
        trend(found, Omega2 - 0.2, Omega1, rising=False),
        steeper(found, Omega2 - 0.2, Omega1, 16.5),
    ]


def figure10(sol: fm.Solution) -> list[Finding]:
    """The shift in case 4."""
    return [shifted(spikes(sol).part(4.0, 12.5)[0], CASES["4"][1])]


def figure11(sol: fm.Solution) -> list[Finding]:
    """Damping weakens the train and delays its onset."""
    free = run("2")
    t = np.linspace(100.0, 600.0, 50001)
    weaker = sol.at(t).velocity("pad.y").std() / free.at(t).velocity("pad.y").std()
    onset, onset_free = (float(s.events.of(kind="stick").t[1]) for s in (sol, free))
    peaks = spikes(sol, prominence=2.0).part(0.5, 8.5)[0]
    return [
        Finding(
            statement="damping weakens the train",
            found=f"the pad's velocity across, from 100 to 600, is {100 * weaker:.1f} % of that of case 2",
            agrees=bool(weaker < 1.0),
        ),
        Finding(
            statement="damping delays the onset of stick-slip",
            found=f"after the catch at the start, sticking comes back at {onset:.1f}, in case 2 at {onset_free:.1f}",
            agrees=onset > onset_free,
        ),
        apart(peaks),
    ]


def figure12(sol: fm.Solution) -> list[Finding]:
    """The angle lags behind the valleys; before the first stick in a run that has such a time."""
    kicks = valleys(sol)
    swings = kicks.sticks & (kicks.begin < 600.0)
    close = swings & (kicks.begin > CLOSE[0]) & (kicks.begin < CLOSE[1])
    gentle = valleys(fm.simulate(brake4dof("2", mu_k_N=5.0, mass_ratio=100.0), t_end=140.0, rtol=1e-8))
    before = ~gentle.sticks
    near = before & (gentle.least < 0.6)
    far = before & (gentle.least > 1.0)
    return [
        Finding(
            statement="every peak of the angle lags slightly behind a valley of the slip",
            found=f"{kicks.lag[close].mean():.3f} behind the end of stick in the stretch shown,"
            f" {kicks.lag[swings].min():.3f} to {kicks.lag[swings].max():.3f} up to 600",
            agrees=bool((kicks.lag[swings] > 0).all()),
        ),
        Finding(
            statement="the angle stays below 1 degree",
            found=f"{np.abs(kicks.angle[close]).max():.2f} degrees in the stretch shown, but"
            f" {np.abs(kicks.angle[swings]).max():.2f} in the first swings",
            agrees=bool(np.abs(kicks.angle[swings]).max() < 1.0),
        ),
        Finding(
            statement="it lags before the first stick, too (a run with muN = 5, R = 100, which has such a time)",
            found=f"by {gentle.lag[near].mean():+.3f} where the slip falls below 0.6, but by"
            f" {gentle.lag[far].mean():+.3f} (it leads a little) where it stays above 1",
            agrees=bool((gentle.lag[before] > 0).all()),
        ),
    ]
