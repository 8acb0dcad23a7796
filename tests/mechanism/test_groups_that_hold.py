"""Bodies on several dry feet hold as long as some forces within all cones do: against linear programs of statics."""

import numpy as np
import pytest
from scipy.optimize import linprog

import fricmb as fm

MU_S, MU_K, G = 0.8, 0.4, 9.81


def box(height, *, heavy=1.0, mu_s=1.0):
    """A box of mass 1 on two feet under the pull 0.1 t at its centre, ``height`` above them; weight 1."""
    law = fm.laws.Coulomb(mu_s=mu_s, mu_k=0.5)
    b = fm.RigidBody("b", mass=heavy, inertia=0.1 * heavy, position=(0.0, height))
    feet = [fm.RollerOnLine(f"r{i}", b.point(f"p{i}", (x, -height)), friction=law) for i, x in enumerate((-0.5, 0.5))]
    pull = fm.Force("F", b, axis="x", value=0.1 * heavy * fm.t)
    return fm.Scene("box", [b, fm.Gravity("g", acceleration={"y": -1.0}), pull, *feet])


@pytest.mark.parametrize("height", [0.0, 0.05, 0.2])
@pytest.mark.parametrize("method", ["auto", "bdf"])
def test_a_box_on_two_feet_breaks_away_as_one(height, method):
    """At 0.1 t = mu_s m g, whatever the pull does to the loads of the feet; then x = T^3/60 + T^2/4, T = t - 10."""
    sol = fm.simulate(box(height), t_end=12.0, rtol=1e-8, method=method)
    assert [(e.contact, e.kind) for e in sol.events] == [("r0", "slip"), ("r1", "slip")]
    np.testing.assert_allclose(sol.events.t, 10.0, rtol=1e-11)
    np.testing.assert_allclose(sol["b.x"][-1], 8.0 / 60.0 + 1.0, rtol=1e-8)
    assert sol.audit().ok, sol.audit()
    assert "nor does the motion depend on it" in sol.stats.notes[0]


@pytest.mark.parametrize("mass", [1e-9, 1e9])
def test_the_size_of_the_body_does_not_matter(mass):
    sol = fm.simulate(box(0.2, heavy=mass), t_end=12.0, rtol=1e-8)
    np.testing.assert_allclose(sol["b.x"][-1], 8.0 / 60.0 + 1.0, rtol=1e-8)


def ladder(angle, wall):
    """A ladder whose foot is pulled away by t from under it; the time it holds, by linear programming of statics."""
    mass, length = 2.0, 4.0
    c, s = np.cos(angle), np.sin(angle)
    b = fm.RigidBody(
        "b", mass=mass, inertia=mass * length**2 / 12, position=(length * c / 2, length * s / 2), angle=angle
    )
    foot, top = b.point("foot", (-length / 2, 0.0)), b.point("top", (length / 2, 0.0))
    floor, side = (fm.laws.Coulomb(mu_s=mu, mu_k=mu / 2) for mu in (MU_S, wall))
    scene = fm.Scene("ladder", [
        b, fm.Gravity("g", acceleration={"y": -G}), fm.Force("F", foot, axis="x", value=-fm.t),
        fm.RollerOnLine("floor", foot, friction=floor, push_only=True),
        fm.RollerOnLine("wall", top, fm.ground_point(length * c, 0.0), angle=np.pi / 2, friction=side, push_only=True),
    ])  # fmt: skip
    # unknown: friction and load at the floor, load and friction at the wall, t
    statics = [[1, 0, -1, 0, -1], [0, 1, 0, 1, 0], [0, 0, length * s, length * c, 0]]
    cones = [[1, -MU_S, 0, 0, 0], [-1, -MU_S, 0, 0, 0], [0, 0, -wall, 1, 0], [0, 0, -wall, -1, 0]]
    best = linprog(
        [0, 0, 0, 0, -1], A_eq=statics, b_eq=[0, mass * G, mass * G * length * c / 2], A_ub=cones, b_ub=np.zeros(4),
        bounds=[(None, None), (0, None), (0, None), (None, None), (0, None)],
    )  # fmt: skip
    return scene, float(best.x[-1])


@pytest.mark.parametrize(("angle", "wall"), [(0.8, 0.8), (0.8, 0.2), (1.0, 0.8), (1.2, 0.2)])
def test_a_ladder_holds_as_long_as_statics_lets_it(angle, wall):
    """Loads of floor and wall depend on how they share, so that shares of least norm let go too early."""
    scene, holds = ladder(angle, wall)
    sol = fm.simulate(scene, t_end=1.02 * holds, rtol=1e-8)
    assert [e.kind for e in sol.events] == ["slip", "slip"]
    np.testing.assert_allclose(sol.events.t, holds, rtol=1e-11)
    assert sol.audit().ok, sol.audit()


FEET = ((0.5, 0.1), (-0.4, 0.3), (-0.1, -0.6))


def tripod(pull, heights):
    """Three feet on planes of their own heights, pulled and turned by loads that grow with t, and the time they hold.

    By linear programming with 1440 planes around each cone: a bound from above, at most 2.4e-6 of forces above.
    """
    mass, law = 2.0, fm.laws.Coulomb(mu_s=MU_S, mu_k=MU_K)
    b = fm.space.RigidBody("b", mass=mass, inertia=(0.1, 0.12, 0.15), position=(0, 0, 0.3))
    feet = [
        fm.space.OnPlane(
            f"p{i}",
            b.point(f"q{i}", (x, y, z - 0.3)),
            normal=(0, 0, 1),
            through=(0, 0, z),
            friction=law,
            push_only=True,
        )
        for i, ((x, y), z) in enumerate(zip(FEET, heights, strict=True))
    ]
    arm = b.point("arm", (1.0, 0.0, 0.0))
    loads = [("x", b, pull[0]), ("y", b, pull[1] - pull[2]), ("y", arm, pull[2])]
    forces = [fm.Force(f"F{i}", at, axis=axis, value=f * fm.t) for i, (axis, at, f) in enumerate(loads) if f != 0.0]
    A, rhs, cones = np.zeros((6, 10)), np.zeros(6), []
    for i, ((x, y), z) in enumerate(zip(FEET, heights, strict=True)):
        A[:3, 3 * i : 3 * i + 3] = np.eye(3)
        A[3:, 3 * i : 3 * i + 3] = np.cross((x, y, z - 0.3), np.eye(3)).T
        for angle in np.linspace(0.0, 2.0 * np.pi, 1440, endpoint=False):
            cones.append(np.zeros(10))
            cones[-1][3 * i : 3 * i + 3] = np.cos(angle), np.sin(angle), -MU_S
    A[:, 9], rhs[2] = [pull[0], pull[1], 0.0, 0.0, 0.0, pull[2]], mass * G
    best = linprog(
        [0.0] * 9 + [-1.0], A_eq=A, b_eq=rhs, A_ub=np.array(cones), b_ub=np.zeros(len(cones)),
        bounds=[(None, None)] * 9 + [(0.0, None)],
    )  # fmt: skip
    scene = fm.Scene("tripod", [b, fm.Gravity("g", acceleration={"z": -G}), *feet, *forces])
    return scene, float(best.x[-1])


@pytest.mark.parametrize(
    ("pull", "heights"),
    [
        ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        ((1.0, 0.3, 0.4), (0.0, 0.0, 0.0)),
        ((1.0, 0.3, 0.4), (0.0, 0.05, -0.1)),
        ((1.0, -0.3, 0.4), (0.0, 0.1, -0.1)),
    ],
)
def test_a_tripod_holds_as_long_as_statics_lets_it(pull, heights):
    scene, holds = tripod(pull, heights)
    sol = fm.simulate(scene, t_end=1.01 * holds, rtol=1e-8, time_limit=60)
    assert [e.kind for e in sol.events] == ["slip"] * 3
    assert -5e-6 * holds <= sol.events.t[0] - holds <= 1e-11 * holds
    assert sol.audit().ok, sol.audit()


@pytest.mark.parametrize("mu_s", [0.6, 0.9, 0.999])
def test_the_audit_sees_a_group_that_lets_go_too_early(mu_s):
    """The motion of feet that hold less, told of these: it satisfies everything but that the group could have held."""
    right, early = (fm.simulate(box(0.2, mu_s=mu), t_end=12.0, rtol=1e-8) for mu in (1.0, mu_s))
    assert right.audit()["release of a group"].ok
    right.run.pieces[0]._trajectory = early.run.pieces[0].trajectory
    audit = right.audit()
    assert not audit["release of a group"].ok, audit
