"""Equations of whole scenes against hand-derived twins, and against the arrays that are integrated."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.equations import function
from fricmb.models import brake4dof
from fricmb.system import build


def symbols(names):
    return sympy.symbols(names, real=True)


def general_brake():
    pad = fm.Body("pad", mass=1.5, axes="xy")
    rotor = fm.Body("rotor", mass=30.0, axes="xy", velocity={"x": 10.0, "y": 0.01})
    return fm.Scene(
        "brake",
        [
            pad,
            rotor,
            fm.Spring("k1x", pad, axis="x", stiffness=2.0),
            fm.Spring("k1y", pad, axis="y", stiffness=3.0),
            fm.Spring("k2y", rotor, axis="y", stiffness=4.0),
            fm.Damper("c1x", pad, axis="x", damping=0.1),
            fm.Damper("c1y", pad, axis="y", damping=0.2),
            fm.Damper("c2y", rotor, axis="y", damping=0.3),
            fm.Contact("lining", pad, rotor, law=fm.laws.Coulomb(mu_s=1.2, mu_k=1.0), normal_force=15.0),
        ],
    )


def test_brake_equals_the_equations_of_its_paper():
    """With general masses and springs, then in the paper's dimensionless form."""
    eq = general_brake().equations()
    x1, y1, x2, y2 = symbols("x_pad y_pad x_rotor y_rotor")
    u1, w1, u2, w2 = symbols("xdot_pad ydot_pad xdot_rotor ydot_rotor")
    Fx, Fy = symbols("F_lining_x F_lining_y")
    m1, m2, k1x, k1y, k2y, c1x, c1y, c2y = symbols("m_pad m_rotor k_1x k_1y k_2y c_1x c_1y c_2y")
    assert list(eq.q) == [x1, y1, x2, y2]
    assert list(eq.v) == [u1, w1, u2, w2]
    assert sympy.diag(m1, m1, m2, m2) == eq.M
    rhs = sympy.Matrix(
        [-k1x * x1 - c1x * u1 + Fx, -k1y * y1 - c1y * w1 + Fy, -Fx, -k2y * y2 - c2y * w2 - Fy],
    )
    assert (eq.rhs - rhs).expand() == sympy.zeros(4, 1)

    O1, O2, d, R = symbols("Omega_1 Omega_2 d R")
    dimensionless = {m1: 1, m2: R, k1x: 1, k1y: O1**2, k2y: R * O2**2, c1x: d, c1y: d, c2y: R * d}
    paper = sympy.Matrix(
        [-x1 - d * u1 + Fx, -(O1**2) * y1 - d * w1 + Fy, -Fx / R, -(O2**2) * y2 - d * w2 - Fy / R],
    )
    accelerations = eq.M.subs(dimensionless).inv() * eq.rhs.subs(dimensionless)
    assert (accelerations - paper).expand() == sympy.zeros(4, 1)

    N, mu_k, mu_s = symbols("N_lining mu_k_lining mu_s_lining")
    (lining,) = eq.contacts
    g = sympy.Matrix([u1 - u2, w1 - w2])
    assert sympy.Matrix(lining.velocity) == g
    assert lining.break_away == mu_s
    slip = eq.slipping().subs(dimensionless)
    expected = paper.subs({Fx: -mu_k * N * g[0] / g.norm(), Fy: -mu_k * N * g[1] / g.norm()})
    assert (eq.M.subs(dimensionless).inv() * slip - expected).applyfunc(sympy.simplify) == sympy.zeros(4, 1)


def test_terms_that_are_zero_are_left_out():
    eq = brake4dof("2").equations()
    assert not any("dot" in str(symbol) for symbol in eq.rhs.free_symbols)
    assert {"k_1x", "k_1y", "k_2y"} <= {str(symbol) for symbol in eq.values}


def test_nonlinear_scene_equals_its_hand_derived_twin():
    """A mass on an inclined line spring with a cubic spring and a line damper, pushed by a force of time and place."""
    gain = fm.parameter("gain", 0.4)
    mass = fm.Body("mass", mass=2.0, axes="xy", position={"x": 1.0, "y": 0.5})
    scene = fm.Scene(
        "pendulum",
        [
            mass,
            fm.PointSpring("rope", mass, stiffness=5.0, length=0.7, anchor=(0.2, 0.0)),
            fm.PointDamper("piston", mass, damping=0.3),
            fm.Spring("stop", mass, axis="x", stiffness=1.0, cubic=3.0, length=0.1),
            fm.Force("push", mass, axis="y", value=gain * sympy.cos(fm.t) * fm.coordinate("mass.x")),
        ],
    )
    eq = scene.equations()
    x, y, u, w, t = symbols("x_mass y_mass xdot_mass ydot_mass t")
    k, L, c, ks, beta, Ls, G = symbols("k_rope L_rope c_piston k_stop kappa_stop L_stop gain")
    ax = sympy.Float(0.2)
    length = sympy.sqrt((x - ax) ** 2 + y**2)
    pull = -k * (length - L) / length
    rate = (x * u + y * w) / (x**2 + y**2)
    e = x - Ls
    twin = sympy.Matrix(
        [
            pull * (x - ax) - c * rate * x - ks * e - beta * e**3,
            pull * y - c * rate * y + G * sympy.cos(t) * x,
        ]
    )
    point = {x: 0.9, y: -0.4, u: 0.3, w: 0.8, t: 1.1}
    values = {k: 5.0, L: 0.7, c: 0.3, ks: 1.0, beta: 3.0, Ls: 0.1, G: 0.4}
    assert {symbol: eq.values[symbol] for symbol in values} == values
    assert eq.rhs.free_symbols == twin.free_symbols
    difference = (eq.rhs - twin).applyfunc(sympy.expand)
    assert np.array(twin.subs(values).subs(point), dtype=float).all()
    np.testing.assert_allclose(np.array(difference.subs(values).subs(point), dtype=float), 0.0, atol=1e-14)
    # the same with every parameter and coordinate another random number
    rng = np.random.default_rng(3)
    for _ in range(5):
        other = {symbol: rng.uniform(0.2, 2.0) for symbol in twin.free_symbols}
        np.testing.assert_allclose(np.array(difference.subs(other), dtype=float), 0.0, atol=1e-12)


def all_in_one():
    """A scene with something of everything that has no contact force at rest."""
    k = fm.parameter("k", 3.0)
    a = fm.Body("a", mass=2.0, axes="xy", position={"x": 0.3, "y": 1.2}, velocity={"x": 0.1})
    b = fm.Body("b", mass=1.0, axes="xy", position={"x": -0.4})
    belt = fm.Driven("belt", velocity={"x": 0.2 + sympy.sin(fm.t)})
    plate = fm.ModalBody(
        "plate",
        frequencies=[1.0, 2.5],
        damping_ratios=[0.01, 0.02],
        masses=[1.5, 0.5],
        shapes={"tip": [[1.0, -0.5], [0.3, 0.8]]},
        axes="xy",
        position={"mode1": 0.2},
    )
    tip = plate.point("tip")
    return fm.Scene(
        "everything",
        [
            a,
            b,
            belt,
            plate,
            fm.Spring("s1", a, belt, axis="x", stiffness=k, cubic=2.0, length=0.1),
            fm.Spring("s2", a, b, axis=(1, 2), stiffness=1.5),
            fm.Spring("s3", tip, b, axis="y", stiffness=4.0),
            fm.PointSpring("ps", a, b, stiffness=10.0, length=0.5),
            fm.PointDamper("pd", b, tip, damping=0.3),
            fm.Damper("d", b, belt, axis="x", damping=0.1),
            fm.Force("load", a, axis="x", value=2.0),
            fm.Force("drive", tip, axis="x", value=3 * sympy.cos(2 * fm.t)),
            fm.Force(
                "follow", a, axis="y", value=k * fm.coordinate("plate.tip.x") * fm.speed("b.x") - fm.coordinate("b.y")
            ),
            fm.Force("feel", a, axis="x", value=0.7 * fm.coordinate("belt.x") - 0.2 * fm.speed("a.y")),
            fm.MatrixElement("gyro", ["a.x", "a.y"], C=[[0.0, 0.5], [-0.5, 0.0]], K=[[1.0, 0.3], [-0.3, 2.0]]),
            fm.MatrixElement("added", ["b.x", "b.y"], M=[[0.5, 0.1], [0.1, 0.25]]),
        ],
    )


def array_forces(system, t, q, v):
    """Forces on the dofs out of the arrays, the slow and obvious way."""
    problem = system.problem
    n, n_u = problem.n, problem.n_u
    table = problem.signals.table
    u = np.zeros((3, n_u))
    for j in range(n_u):
        out = np.zeros(3)
        function(int(table.address[j]))(np.array([t]), table.p[table.p_start[j] : table.p_start[j + 1]].copy(), out)
        u[:, j] = out
    X = np.concatenate([[t], q, v, u[0], u[1]])
    linear = problem.linear
    force = (linear.fx - linear.Kx @ np.r_[q, u[0]] - linear.Cx @ np.r_[v, u[1]])[:n] + linear.B @ u[0]
    elements = problem.elements
    table = elements.table
    for k in range(len(table.address)):
        places = range(table.x_start[k], table.x_start[k + 1])
        forms = [slice(table.form_start[a], table.form_start[a + 1]) for a in places]
        x = np.array([table.form_coefficient[s] @ X[table.form_index[s]] for s in forms])
        x += table.form_constant[table.x_start[k] : table.x_start[k + 1]]
        n_f = elements.f_start[k + 1] - elements.f_start[k]
        out = np.zeros(n_f * (1 + len(x)) + 3)
        function(int(table.address[k]))(x, table.p[table.p_start[k] : table.p_start[k + 1]].copy(), out)
        for i in range(n_f):
            row = elements.f_start[k] + i
            s = slice(elements.spread_start[row], elements.spread_start[row + 1])
            np.add.at(force, elements.spread_dof[s], elements.spread_coefficient[s] * out[i])
    return force


def test_arrays_equal_the_symbolic_equations():
    scene = all_in_one()
    system, eq = build(scene), scene.equations()
    M, rhs = eq.with_numbers()
    x_belt = sympy.Symbol("x_belt", real=True)
    evaluate = sympy.lambdify([eq.t, x_belt, *eq.q, *eq.v], rhs)
    np.testing.assert_allclose(np.array(M, dtype=float), system.problem.linear.M, rtol=1e-14)
    rng = np.random.default_rng(1)
    for t in (0.0, 0.8, 5.0):
        q, v = rng.normal(size=(2, len(scene.dof_names)))
        belt = 0.2 * t + 1.0 - np.cos(t)
        expected = np.ravel(np.array(evaluate(t, belt, *q, *v), dtype=float))
        np.testing.assert_allclose(array_forces(system, t, q, v), expected, rtol=1e-12, atol=1e-12)


def test_latex_has_the_users_names():
    text = general_brake().equations().latex()
    for part in (r"\ddot{x}_{pad}", "k_{1x}", r"F_{lining, x}", r"\mu_{k, lining}", r"\leq", r"\begin{align*}"):
        assert part in text
    assert "xdot" not in text


def test_printed_equations_can_be_read():
    text = str(general_brake().equations())
    assert "m_pad*xddot_pad = F_lining_x - c_1x*xdot_pad - k_1x*x_pad" in text
    assert "(stick)" in text


def test_normal_force_law_acts_on_both_bodies():
    a, b = fm.Body("a", mass=1.0, axes="xy"), fm.Body("b", mass=1.0, axes="xy")
    normal = fm.normal.Spring(axis="y", stiffness=100.0, preload=3.0)
    contact = fm.Contact("c", a, b, law=fm.laws.Stribeck.example(), normal_force=normal)
    eq = fm.Scene("pressed", [a, b, contact]).equations()
    _, rhs = eq.with_numbers()
    ya, yb, F = symbols("y_a y_b F_c_x")
    assert list(rhs.subs({ya: 0.01, yb: 0.0})) == pytest.approx([F, -1.0, -F, 1.0])
    assert list(rhs.subs({ya: 1.0, yb: 0.0})) == pytest.approx([F, -3.0, -F, 3.0])


def test_law_with_states_shows_their_rates():
    a = fm.Body("a", mass=1.0)
    belt = fm.Driven("belt", velocity={"x": 0.1})
    eq = fm.Scene(
        "lugre", [a, belt, fm.Contact("c", a, belt, law=fm.laws.LuGre.example(), normal_force=2.0)]
    ).equations()
    (contact,) = eq.contacts
    assert [str(state) for state in contact.states] == ["z_c_x"]
    assert contact.coefficient is None
    assert r"\frac{d}{d t} z_{c, x}" in eq.latex()


def test_words_stay_words():
    """A body called "mass" has the mass m_mass, no "m_ass"; a parameter called "load" is set upright, no product."""
    mass, load = fm.Body("mass", mass=1.0), fm.parameter("load", 1.0)
    parts = [
        fm.Spring("k1x", mass, axis="x", stiffness=1.0), fm.Damper("cx", mass, axis="x", damping=1.0),
        fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=0.5), normal_force=load),
    ]  # fmt: skip
    latex = fm.Scene("words", [mass, *parts]).equations().latex()
    assert r"m_{mass} \ddot{x}_{mass}" in latex
    assert "k_{1x}" in latex
    assert "c_{x}" in latex
    assert r"\mathrm{load} \mu_{s, sole}" in latex
