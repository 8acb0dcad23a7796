"""Stops and play: what is accepted, and what they state."""

import pickle

import pytest

import fricmb as fm

BLOCK = fm.Body("block", mass=1.0, axes="xy")
WHEEL = fm.RigidBody("wheel", mass=1.0, inertia=0.1)
OTHER = fm.RigidBody("other", mass=1.0, inertia=0.1, position=(1.0, 0.0))


def stop(a=BLOCK, b=fm.GROUND, **keywords):
    return fm.Stop("s", a, b, **{"axis": "x", "upper": 1.0, "stiffness": 10.0, **keywords})


def refused(match, make):
    with pytest.raises(fm.SceneError, match=match):
        make()


def test_coordinates():
    assert dict(stop().local_coordinates()[0].terms) == {"block.x": 1.0}
    assert dict(stop(axis=(0.0, 2.0)).local_coordinates()[0].terms) == {"block.y": 1.0}
    turn = fm.Backlash("m", WHEEL, OTHER, axis="angle", gap=0.1, stiffness=1.0).local_coordinates()
    assert dict(turn[0].terms) == {"wheel.angle": 1.0, "other.angle": -1.0}
    pin = fm.Revolute("pin", WHEEL, OTHER)
    assert dict(stop(OTHER, axis=pin).local_coordinates()[0].terms) == {"other.angle": 1.0, "wheel.angle": -1.0}
    both = fm.Backlash("m", WHEEL, OTHER, ratio=2.0, gap=0.1, stiffness=1.0).local_coordinates()
    assert [dict(form.terms) for form in both] == [{"wheel.angle": 1.0}, {"other.angle": 1.0}]


def test_parameters_and_copies():
    scene = fm.Scene("s", [BLOCK, stop(lower=-1.0, damping=2.0, damping_depth=0.1)])
    assert scene.parameters["s.lower"] == -1.0
    assert scene.with_parameters({"s.damping_depth": 0.2})["s"].damping_depth == 0.2
    assert pickle.loads(pickle.dumps(scene["s"])) == scene["s"]


def test_what_cannot_be_is_refused_by_name():
    refused("lower or upper must be given", lambda: stop(upper=None))
    refused(r"upper must be above lower = 1, got 1", lambda: stop(lower=1.0))
    refused("stiffness must be a finite number > 0, got 0", lambda: stop(stiffness=0.0))
    refused("hunt_crossley must be a finite number >= 0", lambda: stop(hunt_crossley=-1.0))
    refused("damping_depth must be given beside damping", lambda: stop(damping=1.0))
    refused("damping_depth must be a finite number > 0", lambda: stop(damping=1.0, damping_depth=0.0))
    refused("axis must be given", lambda: stop(axis=None))
    refused("axis must be 'x', 'y', 'z', 'angle'", lambda: stop(axis="turn"))
    refused("axis 'z' needs the axis 'z'", lambda: stop(axis="z"))
    refused("a must turn", lambda: stop(axis="angle"))
    assert stop(WHEEL, axis=fm.Prismatic("g", WHEEL)).guide == "g"
    refused("angle must be left out: a guide brings it", lambda: stop(angle=0.1))
    play = {"gap": 0.1, "stiffness": 1.0}
    refused("gap must be a finite number >= 0", lambda: fm.Backlash("m", BLOCK, axis="x", gap=-0.1, stiffness=1.0))
    refused("ratio must be another than 0", lambda: fm.Backlash("m", WHEEL, OTHER, ratio=0.0, **play))
    refused("ratio must be left out beside axis", lambda: fm.Backlash("m", WHEEL, OTHER, axis="x", ratio=1.0, **play))
    refused("axis must be given", lambda: fm.Backlash("m", WHEEL, OTHER, **play))
    refused("a must turn", lambda: fm.Backlash("m", BLOCK, WHEEL, ratio=1.0, **play))


def test_force():
    """By the formula, on both sides and where a spring would pull."""
    k, hc, c, w = 40.0, 0.3, 2.0, 0.05

    for x, v in [(1.02, 0.4), (1.2, 0.5), (1.2, -0.5), (1.02, -9.0), (0.9, 3.0), (-1.1, -0.7), (-1.01, 5.0)]:
        d, rate, sign = (x - 1.0, v, -1.0) if x > 0 else (-1.0 - x, -v, 1.0)
        u = min(1.0, d / w)
        right = sign * max(0.0, k * d * (1 + hc * rate) + c * u**2 * (3 - 2 * u) * rate) if d > 0 else 0.0
        body = fm.Body("block", mass=1.0, position={"x": x}, velocity={"x": v})
        ends = fm.Stop("s", body, axis="x", lower=-1.0, upper=1.0, stiffness=k, hunt_crossley=hc, damping=c,
                            damping_depth=w)  # fmt: skip
        sol = fm.simulate(fm.Scene("s", [body, ends]), t_end=1e-6)
        assert sol["s.force"][0] == pytest.approx(right, abs=1e-12)
        assert sol["block.x.acceleration"][0] == pytest.approx(right, abs=1e-12)


def test_touches_belong_to_stops():
    sol = fm.simulate(fm.Scene("s", [fm.Body("block", mass=1.0)]), t_end=1.0)
    refused("touches: 'block' must be a Stop or a Backlash", lambda: sol.touches("block"))


@pytest.mark.parametrize("given", [([0.0, 1.0], [1.0, 2.0]), fm.Signal([0.0, 1.0], [1.0, 2.0]), float("inf"), "far"])
def test_limits_are_numbers(given):
    refused("Stop 's': upper must be a finite number, got", lambda: stop(upper=given))
    refused("Stop 's': lower must be a finite number, got", lambda: stop(lower=given))
