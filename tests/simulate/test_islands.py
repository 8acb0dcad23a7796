"""Islands run on their own: the same results as all together, parts at rest and idle contacts filled in."""

from dataclasses import dataclass

import numpy as np
import pytest
from numba.core import event

import fricmb as fm
from fricmb._simulate._arguments import Span, check_tolerance
from fricmb._simulate._islands import find_runs
from fricmb._simulate._mechanics import mechanics_of
from fricmb._simulate._result import make_solution
from fricmb.equations import _store
from fricmb.solution import Events

GRID = np.linspace(0.0, 12.0, 241)


def two_oscillators():
    """Two blocks on belts of different speed, a free damped pair, a block at rest, a contact without load."""
    slow, fast = fm.Driven("slow", velocity={"x": 0.3}), fm.Driven("fast", velocity={"x": 1.3})
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=2.0, position={"x": 0.3})
    c, d = fm.Body("c", mass=1.0, position={"x": 1.0}), fm.Body("d", mass=0.5, velocity={"x": -1.0})
    still = fm.Body("still", mass=3.0)
    law = fm.laws.Coulomb(mu_s=0.6, mu_k=0.4)
    return fm.Scene(
        "islands",
        [
            slow, fast, a, b, c, d, still,
            fm.Spring("ka", a, axis="x", stiffness=1.0),
            fm.Spring("kb", b, axis="x", stiffness=3.0),
            fm.Contact("on slow", a, slow, law=law, normal_force=1.0),
            fm.Contact("on fast", b, fast, law=law, normal_force=2.0),
            fm.Spring("kc", c, axis="x", stiffness=2.0),
            fm.Spring("kcd", c, d, axis="x", stiffness=5.0),
            fm.Damper("dcd", c, d, axis="x", damping=0.05),
            fm.Damper("dc", c, axis="x", damping=0.02),
            fm.Spring("ks", still, axis="x", stiffness=7.0),
            fm.Contact("pressed", still, law=law, normal_force=5.0),
            fm.Contact("unloaded", a, b, law=law, normal_force=0.0),
        ],
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Negative(fm.FrictionLaw):
    """Turns negative at r = 5."""

    mu_s: float

    def define_coefficient(self, r):
        return self.mu_s - 0.1 * r


def together(scene, t_end=12.0, **options):
    """The run with all islands as one: what the reduction is compared with."""
    mechanics = mechanics_of(scene).as_one()
    span = Span(t_start=0.0, t_end=t_end, t_eval=None)
    chosen = find_runs(mechanics, "bdf", mechanics.start, span, 1e-6)
    trajectory = chosen.integrator.integrate(
        chosen.problem, mechanics.start, t_end, tolerance=check_tolerance(1e-10, None, mechanics.start.q.size)
    )
    span = Span(t_start=0.0, t_end=t_end, t_eval=GRID)
    return make_solution(mechanics, trajectory, span, "bdf", "", 0.0, 0.0, 1e-6)


@pytest.fixture(scope="module")
def apart():
    return fm.simulate(two_oscillators(), t_end=12.0, rtol=1e-10, t_eval=GRID)


@pytest.fixture(scope="module")
def as_one():
    return together(two_oscillators())


def test_the_reduction_changes_nothing(apart, as_one):
    assert apart.dof_names == as_one.dof_names == ("a.x", "b.x", "c.x", "d.x", "still.x")
    np.testing.assert_allclose(apart.q, as_one.q, rtol=0, atol=2e-8)
    np.testing.assert_allclose(apart.v, as_one.v, rtol=0, atol=1e-7)
    # together, an unloaded contact counts as one that slips without force and turns round
    loaded = Events(e for e in as_one.events if e.contact != "unloaded")
    assert [(e.contact, e.kind) for e in apart.events] == [(e.contact, e.kind) for e in loaded]
    assert len(apart.events) == 4
    np.testing.assert_allclose(apart.events.t, loaded.t, rtol=0, atol=1e-7)
    for name in apart.contact_names:
        np.testing.assert_allclose(apart.normal_force(name), as_one.normal_force(name))
        np.testing.assert_allclose(apart.relative_velocity(name), as_one.relative_velocity(name), atol=1e-7)
        if name != "unloaded":
            assert (apart.mode(name) == as_one.mode(name)).mean() > 0.98
    for term in ("kinetic", "potential", "friction_loss", "damping_loss", "input"):
        np.testing.assert_allclose(getattr(apart.energy, term), getattr(as_one.energy, term), atol=1e-7)


def test_each_island_has_its_own_integrator_and_steps(apart):
    by_dofs = {island.dofs: island for island in apart.stats.islands}
    assert by_dofs.keys() == {("a.x",), ("b.x",), ("c.x", "d.x")}
    assert by_dofs["a.x",].method == by_dofs["b.x",].method == "collocation"
    assert apart.stats.n_steps == sum(island.n_steps for island in by_dofs.values())
    assert "collocation" in apart.stats.method
    assert "2 islands" in apart.stats.why


def test_what_rests_and_what_is_unloaded(apart):
    assert not apart["still.x"].any()
    assert not apart.velocity("still.x").any()
    assert (apart.mode("pressed") == 0).all()
    assert (apart.normal_force("pressed") == 5.0).all()
    assert (apart.mode("unloaded") == 2).all()
    plan = apart.scene.plan()
    assert plan.idle == ("unloaded",)
    assert [item.names for item in plan.resting] == [("still.x", "ks", "pressed")]
    assert "not run" in str(plan)


def test_rows_are_the_steps_of_all_and_transitions_twice(apart):
    free = fm.simulate(two_oscillators(), t_end=12.0, rtol=1e-10)
    assert (np.diff(free.t) >= 0).all()
    assert (free.t[0], free.t[-1]) == (0.0, 12.0)
    for found in free.events:
        here = np.flatnonzero(free.t == found.t)
        assert here.size == 2
        before, after = free.mode(found.contact)[here]
        assert (before, after) == ((1, 0) if found.kind == "stick" else (0, 1))
    np.testing.assert_allclose(free(GRID), np.vstack([apart.q, apart.v]), rtol=0, atol=1e-10)
    assert abs(free.energy.residual).max() < 1e-9


def test_a_start_moves_what_would_rest():
    sol = fm.simulate(two_oscillators(), t_end=2.0, initial={"velocity": {"still.x": 1.0}})
    assert abs(sol["still.x"]).max() > 0.1
    assert any(island.dofs == ("still.x",) for island in sol.stats.islands)


def test_runs_go_on_and_join(apart):
    first = fm.simulate(two_oscillators(), t_end=5.0, rtol=1e-10, t_eval=GRID[GRID <= 5.0])
    second = fm.simulate(two_oscillators(), t_end=12.0, rtol=1e-10, t_eval=GRID[GRID >= 5.0], initial=first)
    joined = fm.Solution.join([first, second])
    np.testing.assert_allclose(joined(GRID), np.vstack([apart.q, apart.v]), rtol=0, atol=2e-9)
    assert [(e.contact, e.kind) for e in joined.events] == [(e.contact, e.kind) for e in apart.events]
    assert abs(joined.energy.residual).max() < 1e-8


def test_files_hold_islands(apart, tmp_path):
    apart.save(tmp_path / "run.npz")
    back = fm.Solution.load(tmp_path / "run.npz")
    assert back.stats == apart.stats
    np.testing.assert_array_equal(back.q, apart.q)
    np.testing.assert_allclose(back(GRID[::10]), apart(GRID[::10]), rtol=0, atol=0)
    assert back.end.mode.tolist() == apart.end.mode.tolist()
    further = fm.simulate(back.scene, t_end=13.0, initial=back)
    assert further.t[0] == 12.0


def test_observe_leaves_out_what_has_no_influence(apart):
    sol = fm.simulate(two_oscillators(), t_end=12.0, rtol=1e-10, t_eval=GRID, observe=["on fast"])
    assert sol.dof_names == ("b.x",)
    assert sol.contact_names == ("on fast",)
    np.testing.assert_allclose(sol["b.x"], apart["b.x"], rtol=0, atol=1e-12)
    left = sol.scene.plan()  # of everything
    assert left.left_out == ()


def test_influence_has_a_direction():
    """A load that looks at another body needs it; the other body does not need the load."""
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0, position={"x": 1.0})
    scene = fm.Scene(
        "one way",
        [a, b, fm.Spring("k", b, axis="x", stiffness=1.0), fm.Force("f", a, axis="x", value=2 * fm.coordinate("b.x"))],
    )
    alone = fm.simulate(scene, t_end=3.0, rtol=1e-9, observe=["b.x"])
    assert alone.dof_names == ("b.x",)
    np.testing.assert_allclose(alone["b.x"], np.cos(alone.t), atol=1e-8)
    both = fm.simulate(scene, t_end=3.0, rtol=1e-9, observe=["a.x"])
    assert set(both.dof_names) == {"a.x", "b.x"}
    np.testing.assert_allclose(both["a.x"], 2 * (1 - np.cos(both.t)), atol=1e-7)


def test_a_failed_island_ends_the_run_where_it_failed():
    a, b = fm.Body("a", mass=1.0, velocity={"x": 1.0}), fm.Body("b", mass=1.0, position={"x": 1.0})
    scene = fm.Scene(
        "falls",
        [
            a, b,
            fm.Force("push", a, axis="x", value=2.0),
            fm.Contact("c", a, law=Negative(mu_s=0.5), normal_force=1.0),
            fm.Spring("k", b, axis="x", stiffness=1.0),
        ],
    )  # fmt: skip
    with pytest.raises(fm.IntegrationError, match="negative") as caught:
        fm.simulate(scene, t_end=20.0)
    partial = caught.value.partial
    assert partial.t_end <= caught.value.t < 20.0
    np.testing.assert_allclose(partial["b.x"], np.cos(partial.t), atol=1e-9)


def test_a_method_by_name_runs_every_island_that_it_takes():
    sol = fm.simulate(two_oscillators(), t_end=12.0, rtol=1e-10, t_eval=GRID, method="bdf")
    assert {island.method for island in sol.stats.islands} == {"bdf"}


def test_fixed_steps():
    sol = fm.simulate(two_oscillators(), t_end=1.0, method="bdf2-paper", step=0.01)
    assert {island.method for island in sol.stats.islands} == {"bdf2-paper"}


def test_long_runs_keep_the_times_asked_for(apart):
    sol = fm.simulate(two_oscillators(), t_end=12.0, rtol=1e-10, t_eval=GRID, dense=False)
    np.testing.assert_allclose(sol.q, apart.q, rtol=0, atol=1e-9)


def test_inert_parts_are_not_run():
    parts = list(fm.models.brake4dof("2").parts)
    for i in range(100):
        body = fm.Body(f"idle{i}", mass=1.0, axes="xy")
        parts += [body, fm.Spring(f"hold{i}", body, axis="x", stiffness=1.0 + i)]
    plain = fm.simulate(fm.models.brake4dof("2"), t_end=20.0, rtol=1e-8)
    more = fm.simulate(fm.Scene("with idle parts", parts), t_end=20.0, rtol=1e-8)
    assert more.stats.n_steps == plain.stats.n_steps
    assert len(more.stats.islands) == 1
    np.testing.assert_array_equal(more.t, plain.t)
    np.testing.assert_array_equal(more.q[:4], plain.q)
    assert not more.q[4:].any()
    assert more.scene.plan().counts["islands at rest"] == 200


def test_fifty_values_derive_and_compile_nothing(monkeypatch):
    scene = fm.models.brake4dof("2")
    fm.simulate(scene, t_end=1.0)
    looked_up = []
    read = _store.read
    monkeypatch.setattr(_store, "read", lambda name: looked_up.append(name) or read(name))
    with event.install_recorder("numba:compile") as compiled:
        for i in range(50):
            fm.simulate(scene, t_end=1.0, parameters={"k1x.stiffness": 1.0 + 0.02 * i, "lining.normal_force": 10.0 + i})
    assert compiled.buffer == []
    assert looked_up == []  # not even on the disk: all templates are in memory


def dry_pendulum(name, at):
    """A link on a dry pin."""
    link = fm.RigidBody(name, mass=1.0, inertia=0.1, position=(at + 0.5, 0.0), points={"root": (-0.5, 0.0)})
    law = fm.laws.Coulomb(mu_s=0.3, mu_k=0.2)
    return [link, fm.Revolute(f"pin {name}", link.point("root"), fm.ground_point(at, 0.0), radius=0.1, friction=law)]


def test_islands_with_joints_move_as_alone():
    """To the last bit, reactions and transitions too; a free body that turns is one island."""
    free = fm.RigidBody("free", mass=1.0, inertia=1.0, velocity=(1.0, 0.0), angular_velocity=2.0)
    gravity, push = fm.Gravity("g"), fm.Force("push", free, axis="x", value=1.0)
    parts = [*dry_pendulum("a", 0.0), *dry_pendulum("b", 3.0), free, gravity, push]
    sol = fm.simulate(fm.Scene("three", parts), t_end=2.0)
    alone = fm.simulate(fm.Scene("one", [*dry_pendulum("a", 0.0), fm.Gravity("g")]), t_end=2.0)
    assert len(sol.stats.islands) == 3
    assert sol["a.angle"][-1] == alone["a.angle"][-1]
    assert [(e.kind, e.t) for e in sol.events if e.contact == "pin a"] == [(e.kind, e.t) for e in alone.events]
    np.testing.assert_array_equal(sol.reaction("pin a")[:, -1], alone.reaction("pin a")[:, -1])
    assert sol["free.x"][-1] == pytest.approx(4.0, abs=1e-12)
    assert sol.audit().ok
    with pytest.raises(KeyError, match="unknown joint 'pin c'"):
        sol.reaction("pin c")


@pytest.mark.parametrize("length", [1e-6, 1e6])
def test_what_is_idle_beside_has_no_part_in_scales(length):
    """A block that is braked to rest on the plane, beside a pendulum of another size."""
    top = fm.RigidBody("bob", mass=1e5, inertia=1e5 * length**2, position=(0.0, -length), points={"top": (0.0, length)},
                       angular_velocity=3.0)  # fmt: skip
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"x": 0.3, "y": 0.4})
    rubs = fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0, axes="xy")
    scene = fm.Scene("beside", [top, fm.Revolute("pin", top.point("top")), block, rubs])
    (stop,) = fm.simulate(scene, t_end=2.0, method="radau").events
    assert stop.t == pytest.approx(1.0, abs=1e-7)
