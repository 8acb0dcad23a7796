"""The size of error that an audit sees: right runs, all of one kind of value off by a smooth part of its largest."""

import dataclasses

import numpy as np
import pytest

import fricmb as fm
from tests.audit.changed import Changed

SCENES = {
    "belt": (fm.models.belt_oscillator(mu_s=1.5, mu_k=1.0), 60.0),
    "chain": (fm.models.stick_slip_chain(3), 60.0),
    "joint": (fm.models.dry_pendulum(), 4.0),
}


def off(name, part):
    def change(samples):
        x = getattr(samples, name)
        return dataclasses.replace(samples, **{name: x + part * np.abs(x).max() * np.sin(7.3 * samples.t + 1.0)})

    return change


def late(held, begin, by):
    """What follows ``begin``, a transition, comes later."""

    def change(samples):
        t = np.where(samples.t > begin, np.maximum(samples.t - by, begin), samples.t)
        return dataclasses.replace(held.sample(t), t=samples.t)

    return change


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
@pytest.mark.parametrize("scene", SCENES)
def test_errors_of_a_hundred_tolerances_are_seen(scene, rtol):
    """Positions, forces and loads off by 100 rtol, velocities and the time of one transition by 10 rtol of the run."""
    made, t_end = SCENES[scene]
    sol = fm.simulate(made, t_end=t_end, rtol=rtol)
    assert sol.audit().ok
    piece = sol.run.pieces[0]
    held = piece.trajectory
    begin = float(sol.events.t[len(sol.events) // 2])
    changes = {name: off(name, 100.0 * rtol) for name in ("q", "F", "N")}
    changes |= {"v": off("v", 10.0 * rtol), "time": late(held, begin, 10.0 * rtol * t_end)}
    for name, change in changes.items():
        piece._trajectory = Changed(held, change)
        assert not sol.audit().ok, name
