"""Equations of trees in joint coordinates: textbook forms, and the accelerations of the full equations."""

import numpy as np
import sympy

import fricmb as fm


def test_a_pendulum_is_one_equation():
    arm = fm.RigidBody("arm", mass=1.3, inertia=0.2, position=(0.7, 0.0), points={"pin": (-0.7, 0.0)})
    law = fm.laws.Coulomb(mu_s=0.6)
    pin = fm.Revolute("pin", arm.point("pin"), radius=0.05, friction=law)
    found = fm.Scene("pendulum", [arm, pin, fm.Gravity("g")]).equations(joint_coordinates=True)
    assert found.dof_names == ("pin.angle",)
    assert not found.constraints
    M, rhs = found.with_numbers()
    np.testing.assert_allclose(float(M[0]), 0.2 + 1.3 * 0.49, rtol=1e-14)
    F = found.contacts[0].force[0]
    values = {found.q[0]: 0.4, found.v[0]: 2.0, F: 3.0}
    np.testing.assert_allclose(float(rhs[0].xreplace(values)), -1.3 * 9.81 * 0.7 * np.cos(0.4) + 3.0 * 0.05, rtol=1e-14)


def tree():
    arm = fm.RigidBody(
        "arm", mass=1.3, inertia=0.2, position=(0.7, 0.0), points={"pin": (-0.7, 0.0), "tip": (0.5, 0.1)}
    )
    slider = fm.RigidBody("slider", mass=0.4, inertia=0.03, position=(1.5, 0.1), angle=0.3, points={"eye": (0.1, 0.05)})
    plate = fm.RigidBody("plate", mass=0.2, inertia=0.01, position=(1.8, 0.2), points={"edge": (-0.2, 0.0)})
    bob = fm.RigidBody("bob", mass=0.5, inertia=0.02, position=(2.0, -0.3), points={"up": (0.0, 0.4)})
    return fm.Scene("tree", [
        arm, slider, plate, bob, fm.Gravity("g"),
        fm.Revolute("pin", arm.point("pin")),
        fm.Prismatic("guide", arm.point("tip"), slider, angle=0.2),
        fm.Fixed("weld", plate.point("edge"), slider.point("eye")),
        fm.Revolute("hook", bob.point("up"), plate),
        fm.Rod("stay", bob, fm.ground_point(3.0, -1.0), length=1.3),
        fm.PointSpring("spring", bob, fm.ground_point(0.0, -2.0), stiffness=30.0, length=0.3),
    ])  # fmt: skip


def accelerations(equations, q, v):
    """Of ``M a = f + G^T lambda``, G a = -G' v, at numbers for coordinates and velocities."""
    M, rhs = equations.with_numbers()
    values = {s: sympy.Float(x) for s, x in equations.values.items()}
    at = {**dict(zip(equations.q, q, strict=True)), **dict(zip(equations.v, v, strict=True))}
    phi = sympy.Matrix([e.xreplace(values) for c in equations.constraints for e in c.expressions])
    lam = [m for c in equations.constraints for m in c.multipliers]
    G = phi.jacobian(equations.q)
    bend = (G * equations.v).jacobian(equations.q) * equations.v
    M, G, bend, f = (np.array(x.xreplace(at).xreplace(dict.fromkeys(lam, 0)), float) for x in (M, G, bend, rhs))
    k = len(lam)
    whole = np.block([[M, -G.T], [G, np.zeros((k, k))]])
    return np.linalg.solve(whole, np.concatenate([f.ravel(), -bend.ravel()]))[: len(q)]


def test_a_tree_with_a_loop_moves_as_in_coordinates_of_bodies():
    scene = tree()
    sol = fm.simulate(scene, t_end=0.2, rtol=1e-10)
    whole, found = scene.equations(), scene.equations(joint_coordinates=True)
    assert found.dof_names == ("pin.angle", "guide.slide", "hook.angle")
    assert [c.name for c in found.constraints] == ["stay"]
    q, v = sol.q[:, -1], sol.v[:, -1]
    a = accelerations(whole, q, v)
    # joint coordinates, their rates and second derivatives from those of the bodies
    at = dict(zip(whole.dof_names, range(len(q)), strict=True))
    of = {"pin.angle": {"arm.angle": 1.0}, "hook.angle": {"bob.angle": 1.0, "plate.angle": -1.0}}
    s, rate, second = np.zeros((3, 3))
    for i, name in enumerate(found.dof_names):
        for dof, c in of.get(name, {}).items():
            s[i], rate[i], second[i] = (
                x + c * y[at[dof]] for x, y in zip((s[i], rate[i], second[i]), (q, v, a), strict=True)
            )
    t = sol.t[-1] + np.linspace(-1e-2, 0.0, 9)

    def slide(x, y, turn):
        return x * np.cos(turn + 0.2) + y * np.sin(turn + 0.2)

    now = sol.at(t)
    along = slide(now["arm.tip.x"] - now["slider.x"], now["arm.tip.y"] - now["slider.y"], now["slider.angle"])
    poly = np.polynomial.Polynomial.fit(t, along, 8)
    s[1], rate[1], second[1] = (poly.deriv(k)(t[-1]) if k else along[-1] for k in range(3))
    np.testing.assert_allclose(accelerations(found, s, rate), second, rtol=1e-4)
