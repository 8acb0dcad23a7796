"""Arrays of scenes against arrays written by hand."""

import numpy as np
import pytest
import scipy.sparse
import sympy

import fricmb as fm
from fricmb.equations import derivations, function
from fricmb.integrate.problem import (
    LAW_COEFFICIENT,
    LAW_CONSTANT,
    LAW_SMOOTH,
    NORMAL_CONSTANT,
    NORMAL_EXPRESSION,
    NORMAL_LAW,
)
from fricmb.models import brake4dof
from fricmb.plan import make_plan
from fricmb.system import build


def coulomb(mu=0.5):
    return fm.laws.Coulomb(mu_s=mu)


def test_brake():
    system = build(brake4dof("5", mu_s_N=18.0))
    linear, contacts = system.problem.linear, system.problem.contacts
    O1, O2 = 100 * np.pi / 2, 2.5e-4
    np.testing.assert_array_equal(linear.M, np.diag([1.0, 1.0, 1000.0, 1000.0]))
    np.testing.assert_allclose(linear.Kx, np.diag([1.0, O1, 0.0, 1000 * O2]), rtol=1e-14)
    np.testing.assert_allclose(linear.Cx, np.diag([0.01, 0.01, 0.0, 10.0]), rtol=1e-14)
    np.testing.assert_array_equal(contacts.W, [[1, 0], [0, 1], [-1, 0], [0, -1]])
    assert contacts.law.tolist() == [LAW_CONSTANT]
    assert contacts.normal.tolist() == [NORMAL_CONSTANT]
    assert contacts.N.tolist() == [15.0]
    np.testing.assert_allclose((contacts.mu_s, contacts.mu_0), [[1.2], [1.0]], rtol=1e-15)
    assert system.problem.n_u == system.problem.n_z == len(system.problem.elements.table.address) == 0
    assert system.start.v.tolist() == [0.0, 0.0, 10.0, 0.01]
    assert system.dof_names == ("pad.x", "pad.y", "rotor.x", "rotor.y")
    assert (system.contact_names, system.contact_axes) == (("lining",), (("x", "y"),))
    np.testing.assert_allclose(system.problem.omega, [0, np.sqrt(O2), 1, np.sqrt(O1)], rtol=1e-12)
    expected = [0, 0.005 / np.sqrt(O2), 0.005, 0.005 / np.sqrt(O1)]
    np.testing.assert_allclose(system.problem.zeta, expected, rtol=1e-12)


def test_a_system_stays_with_its_scene():
    scene = brake4dof("2")
    assert build(scene) is build(scene)
    assert build(scene, make_plan(scene)) is build(scene, make_plan(scene))


def test_values_change_without_deriving():
    scene = brake4dof("2")
    build(scene)
    count = len(derivations)
    other = scene.with_parameters({"k1x.stiffness": 7.0, "c1x.damping": 0.3, "lining.law.mu_s": 2.0})
    problem = build(other).problem
    assert problem.linear.Kx[0, 0] == 7.0
    assert problem.linear.Cx[0, 0] == 0.3
    assert problem.contacts.mu_s[0] == 2.0
    # a value that leaves 0 brings its template back
    assert len(build(other.with_parameters({"k1x.cubic": 0.1})).problem.elements.table.address) == 1
    assert len(derivations) == count


def belt_scene(**contact):
    body = fm.Body("m", mass=2.0, axes="xy")
    belt = fm.Driven("belt", velocity={"x": 0.3, "y": 0.1 * fm.t})
    given = {"law": coulomb(), "normal_force": 2.0} | contact
    return fm.Scene("belt", [body, belt, fm.Contact("sole", body, belt, **given)])


def test_relative_velocity_of_a_belt():
    """g = W^T v - w - Wu u': a constant velocity needs no signal."""
    problem = build(belt_scene()).problem
    assert problem.n_u == 1
    np.testing.assert_array_equal(problem.contacts.w, [0.3, 0.0])
    np.testing.assert_array_equal(problem.contacts.Wu, [[0.0], [1.0]])
    np.testing.assert_array_equal(problem.contacts.W, np.eye(2))


def test_slide_is_added_to_the_relative_velocity():
    problem = build(belt_scene(slide=(0.5, sympy.sin(fm.t)))).problem
    np.testing.assert_allclose(problem.contacts.w, [-0.2, 0.0])
    np.testing.assert_array_equal(problem.contacts.Wu, [[0.0, 0.0], [1.0, -1.0]])


def test_slanted_direction_and_ground():
    body = fm.Body("m", mass=2.0, axes="xy")
    contact = fm.Contact("c", body, law=coulomb(), normal_force=1.0, axes=[(3.0, 4.0)])
    contacts = build(fm.Scene("s", [body, contact])).problem.contacts
    np.testing.assert_allclose(contacts.W, [[0.6], [0.8]])
    assert contacts.row.tolist() == [0, 1]


def test_springs_between_bodies_and_driven_ends():
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0)
    shaker = fm.Driven("shaker", position={"x": sympy.cos(fm.t)})
    shelf = fm.Driven("shelf", position={"x": 0.5})
    scene = fm.Scene(
        "s",
        [
            a,
            b,
            shaker,
            shelf,
            fm.Spring("ab", a, b, axis="x", stiffness=2.0, length=0.1),
            fm.Spring("bs", b, shaker, axis="x", stiffness=3.0),
            fm.Damper("as", a, shaker, axis="x", damping=0.4),
            fm.Spring("shelf spring", a, shelf, axis="x", stiffness=10.0),
        ],
    )
    problem = build(scene).problem
    # a driven body at rest is a constant, not a signal
    assert problem.n_u == 1
    np.testing.assert_allclose(problem.linear.Kx, [[12, -2, 0], [-2, 5, -3], [0, -3, 3]])
    np.testing.assert_allclose(problem.linear.Cx, [[0.4, 0, -0.4], [0, 0, 0], [-0.4, 0, 0.4]])
    np.testing.assert_allclose(problem.linear.fx, [5.2, -0.2, 0.0])


def test_forces_term_by_term():
    a = fm.Body("a", mass=1.0)
    value = 2 + 3 * sympy.sin(fm.t) - 4 * fm.coordinate("a.x") + 0.5 * fm.speed("a.x")
    problem = build(fm.Scene("s", [a, fm.Force("f", a, axis="x", value=value)])).problem
    assert problem.linear.fx.tolist() == [2.0, 0.0]
    assert problem.linear.Kx[0, 0] == 4.0
    assert problem.linear.Cx[0, 0] == -0.5
    assert problem.linear.B.tolist() == [[1.0]]
    assert len(problem.elements.table.address) == 0


def test_modal_body():
    shapes = {"tip": np.array([[1.0, -2.0, 0.5], [0.0, 3.0, 1.0]]), "root": np.zeros((2, 3))}
    plate = fm.ModalBody(
        "plate", frequencies=[0.0, 2.0, 3.0], damping_ratios=[0.0, 0.1, 0.2], masses=[1, 2, 4], shapes=shapes, axes="xy"
    )
    parts = [plate, fm.Contact("c", plate.point("tip"), law=coulomb(), normal_force=1.0)]
    problem = build(fm.Scene("s", parts)).problem
    np.testing.assert_allclose(problem.linear.M, np.diag([1.0, 2.0, 4.0]))
    np.testing.assert_allclose(problem.linear.Kx, np.diag([0.0, 8.0, 36.0]))
    np.testing.assert_allclose(problem.linear.Cx, np.diag([0.0, 0.8, 4.8]))
    np.testing.assert_allclose(problem.contacts.W, shapes["tip"].T)
    np.testing.assert_allclose(problem.omega, [0.0, 2.0, 3.0])
    np.testing.assert_allclose(problem.zeta, [0.0, 0.1, 0.2])


@pytest.mark.parametrize("form", [np.array, scipy.sparse.csr_matrix], ids=["dense", "sparse"])
def test_matrix_element(form):
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=2.0)
    K = [[2.0, 1.0], [-1.0, 3.0]]
    element = fm.MatrixElement("m", ["b.x", "a.x"], M=form([[0.5, 0.1], [0.1, 0.2]]), K=form(K))
    problem = build(fm.Scene("s", [a, b, element])).problem
    np.testing.assert_allclose(problem.linear.M, [[1.2, 0.1], [0.1, 2.5]])
    np.testing.assert_allclose(problem.linear.Kx, [[3.0, -1.0], [1.0, 2.0]])


def table_value(table, k, X, n_out):
    out = np.zeros(n_out)
    x = []
    for a in range(table.x_start[k], table.x_start[k + 1]):
        s = slice(table.form_start[a], table.form_start[a + 1])
        x.append(table.form_constant[a] + table.form_coefficient[s] @ X[table.form_index[s]])
    function(int(table.address[k]))(np.array(x), table.p[table.p_start[k] : table.p_start[k + 1]].copy(), out)
    return out


def test_kinds_of_laws_and_normal_forces():
    a, b = fm.Body("a", mass=1.0, axes="xy"), fm.Body("b", mass=1.0, axes="xy")
    N0 = fm.parameter("N0", 4.0)
    scene = fm.Scene(
        "s",
        [
            a,
            b,
            fm.Contact(
                "law",
                a,
                b,
                law=fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.1),
                normal_force=fm.normal.Spring(axis="y", stiffness=50.0, damping=2.0, preload=N0),
            ),
            fm.Contact(
                "expression",
                a,
                law=fm.laws.LuGre.example(),
                normal_force=N0 + 0.5 * fm.coordinate("b.y") + sympy.sin(fm.t),
                axes="xy",
            ),
        ],
    )
    system = build(scene)
    contacts = system.problem.contacts
    assert contacts.law.tolist() == [LAW_COEFFICIENT, LAW_SMOOTH]
    assert contacts.normal.tolist() == [NORMAL_LAW, NORMAL_EXPRESSION]
    assert contacts.row.tolist() == [0, 1, 3]
    assert contacts.z_start.tolist() == [0, 0, 2]
    assert system.state_names == ((), ("z.x", "z.y"))
    assert contacts.N0.tolist() == [4.0, 0.0]
    np.testing.assert_array_equal(contacts.Wn, [[0, 0], [1, 0], [0, 0], [-1, 0]])
    assert (contacts.mu_s[0], contacts.mu_0[0]) == pytest.approx((0.6, 0.6))
    t, q, v = 0.7, np.array([0.1, 0.02, -0.3, 0.01]), np.array([1.0, 0.2, 0.0, -0.1])
    X = np.concatenate([[t], q, v])
    N = 4.0 - 50.0 * 0.01 - 2.0 * 0.3
    np.testing.assert_allclose(table_value(contacts.normal_table, 0, X, 5), [N, -50.0, -2.0, 0.0025, 0.5])
    found = table_value(contacts.normal_table, 1, X, 3)
    np.testing.assert_allclose(found, [4.0 + 0.005 + np.sin(0.7), 0.5, np.cos(0.7)])


def test_a_load_dependent_law_has_its_limit_at_the_load():
    from dataclasses import dataclass

    @dataclass(frozen=True, kw_only=True)
    class Loaded(fm.FrictionLaw):
        mu: float

        def define_coefficient(self, r, N):
            return self.mu / (1 + r) / sympy.sqrt(N)

    body = fm.Body("m", mass=1.0)
    contacts = build(
        fm.Scene("s", [body, fm.Contact("c", body, law=Loaded(mu=0.6), normal_force=4.0)]),
    ).problem.contacts
    assert contacts.mu_0[0] == pytest.approx(0.3)
    assert contacts.mu_s[0] == pytest.approx(0.3)


def test_breakpoints_known_and_searched():
    a = fm.Body("a", mass=1.0)
    w = fm.parameter("w", 2.0)
    value = sympy.sign(sympy.sin(w * fm.t)) + sympy.Heaviside(fm.t - w)
    system = build(fm.Scene("s", [a, fm.Force("f", a, axis="x", value=value)]))
    assert system.problem.signals.breakpoints.tolist() == [2.0]
    found = system.problem_for(1.0, 7.0).signals.breakpoints
    np.testing.assert_allclose(found, sorted([2.0, *(np.arange(1, 5) * np.pi / 2)]), rtol=1e-12)
    system = build(brake4dof("2"))
    assert system.problem_for(0.0, 1.0) is system.problem


@pytest.mark.parametrize(("value", "instants"), [
    (sympy.Max(0, 1 - sympy.Abs(fm.t - 18.8162) / 1e-7), [18.8162 - 1e-7, 18.8162, 18.8162 + 1e-7]),
    (sympy.Max(0, sympy.exp(-(((fm.t - 7.123) / 1e-4) ** 2)) - 0.5),
     7.123 + 1e-4 * np.sqrt(np.log(2.0)) * np.array([-1.0, 1.0])),
    (sympy.Piecewise((1, sympy.sin(3 * fm.t) ** 2 > 0.99999), (0, True)),
     np.sort([(np.pi * (k + 0.5) + s * np.arcsin(np.sqrt(1e-5))) / 3.0 for k in range(30) for s in (-1, 1)])),
    (sympy.Abs(fm.t**2 - 2.0 * fm.t + 1.0), []),
])  # fmt: skip
def test_breakpoints_are_found_however_close_they_are(value, instants):
    """Pulses between two times of any grid; a function that touches 0 has no sign change."""
    body = fm.Body("a", mass=1.0)
    scene = fm.Scene("s", [body, fm.Force("f", body, axis="x", value=value)])
    found = build(scene).problem_for(0.0, 31.5).signals.breakpoints
    np.testing.assert_allclose(found, instants, rtol=0.0, atol=1e-11)


def test_what_cannot_matter_is_not_built():
    a, b = fm.Body("a", mass=1.0, velocity={"x": 1.0}), fm.Body("b", mass=3.0, axes="xy", velocity={"y": 2.0})
    parts = [
        a,
        b,
        fm.Spring("ka", a, axis="x", stiffness=1.0),
        fm.Contact("ca", a, law=coulomb(), normal_force=1.0),
        fm.Spring("kx", b, axis="x", stiffness=4.0),
        fm.Spring("ky", b, axis="y", stiffness=5.0),
    ]
    scene = fm.Scene("s", parts)
    assert build(scene).problem.n == 3
    system = build(scene, make_plan(scene, ["b.y"]))
    assert system.dof_names == ("b.y",)
    assert system.problem.linear.Kx.tolist() == [[5.0]]
    assert system.start.v.tolist() == [2.0]
    assert system.problem.n_c == 0


@pytest.mark.parametrize(
    ("mass", "word"), [([[-1.0, 0.0], [0.0, 0.0]], "singular"), ([[-3.0, 0.5], [0.5, 0.0]], "indefinite")]
)
def test_a_mass_matrix_must_be_positive_definite(mass, word):
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=2.0)
    coupled = fm.MatrixElement("couple", ["a.x", "b.x"], M=[[0.0, 0.01], [0.01, 0.0]])
    lumped = fm.MatrixElement("m", ["a.x", "b.x"], M=mass)
    with pytest.raises(fm.SceneError, match=r"a\.x"):
        build(fm.Scene("s", [a, b, lumped]))
    if word == "indefinite":
        with pytest.raises(fm.SceneError, match=r"indefinite.*'a\.x'"):
            build(fm.Scene("s", [a, b, coupled, lumped]))


def test_a_point_spring_needs_a_direction_at_the_start():
    a = fm.Body("a", mass=1.0, axes="xy")
    with pytest.raises(fm.SceneError, match=r"'rope'.*coincide"):
        build(fm.Scene("s", [a, fm.PointSpring("rope", a, stiffness=1.0, length=0.5)]))
    # without a natural length it is a linear spring and needs none
    assert build(fm.Scene("s", [a, fm.PointSpring("rope", a, stiffness=1.0)])).problem.linear.Kx[1, 1] == 1.0


def test_a_position_without_closed_form_is_asked_for():
    velocity = sympy.Piecewise((sympy.sin(sympy.sin(fm.t)), fm.t < 1), (sympy.cos(sympy.cos(fm.t)), True))
    a, belt = fm.Body("a", mass=1.0), fm.Driven("belt", velocity={"x": velocity})
    sole = fm.Contact("sole", a, belt, law=coulomb(), normal_force=1.0)
    assert build(fm.Scene("s", [a, belt, sole])).problem.n_u == 1
    with pytest.raises(fm.SceneError, match=r"'belt'.*position="):
        build(fm.Scene("s", [a, belt, fm.Spring("k", a, belt, axis="x", stiffness=1.0)]))
