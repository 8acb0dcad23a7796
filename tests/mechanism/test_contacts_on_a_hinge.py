"""Several contacts hold a body on a hinge together: what they hold is shared until it is all they can."""

import numpy as np
import pytest

import fricmb as fm

#: Of each contact where it is, and its coefficient.
AT = {"p": ((0.2, 0.0), 0.4), "q": ((-0.1, 0.15), 0.3), "r": ((-0.05, -0.2), 0.5)}
LOAD = 5.0


@pytest.mark.parametrize("rtol", [1e-3, 1e-9])
def test_contacts_on_a_hinge_let_go_as_one(rtol):
    """The moment that they bear is the sum of each one's load, coefficient and distance from the hinge."""
    points = {"hole": (0, 0)} | {name: at for name, (at, _) in AT.items()}
    bar = fm.RigidBody("bar", mass=2.0, inertia=0.2, points=points)
    dry = [
        fm.Contact(f"c{name}", bar.point(name), law=fm.laws.Coulomb(mu_s=mu), normal_force=LOAD, axes="xy")
        for name, (_, mu) in AT.items()
    ]
    push = fm.Force("push", bar.point("p"), axis="y", value=4.0 * fm.t)
    scene = fm.Scene("bar", [bar, fm.Revolute("hinge", bar.point("hole")), push, *dry])
    sol = fm.simulate(scene, t_end=1.6, rtol=rtol, method="radau", time_limit=60.0)
    parts = sum(LOAD * mu * np.hypot(*at) for at, mu in AT.values()) / (4.0 * 0.2)
    assert sorted((e.contact, e.kind) for e in sol.events) == [("cp", "slip"), ("cq", "slip"), ("cr", "slip")]
    np.testing.assert_allclose([e.t for e in sol.events], parts, rtol=1e-9)
    held = sol.at(np.array([1.4]))
    forces = np.array([held.force(f"c{name}")[:, 0] for name in AT])
    assert (np.hypot(*forces.T) <= np.array([LOAD * mu for _, mu in AT.values()]) * (1.0 + 1e-9)).all()
    # the hinge bears what is left
    np.testing.assert_allclose(held.reaction("hinge")[:2, 0], -forces.sum(axis=0) - [0.0, 4.0 * 1.4], atol=1e-8)
