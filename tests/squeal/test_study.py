"""Squeal studies against closed forms of two modes, numpy's eigenvalues of matrices written down here, and runs."""

import csv
import dataclasses
import re

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.cli import main
from fricmb.squeal._place import Places
from tests.real import GROWING, industrial_brake, needs_real

#: Hoffmann's model: K = [[a, b - mu k], [b, d + k]]; flutter from mu = ((a - d - k)^2/(4 b) + b)/k on, 0.75 here.
A, B, D, K = 2.0, 1.0, 2.0 / 3.0, 4.0 / 3.0
MU, PRESS = "lining.law.mu_k", "lining.normal_force.stiffness"


def two_modes(mu=0.3, damping=(0.0, 0.0), speed=1.0):
    mass = fm.Body("mass", mass=1.0, axes="xy")
    belt = fm.Driven("belt", velocity={"x": -speed})
    structure = fm.MatrixElement("structure", ["mass.x", "mass.y"], K=[[A, B], [B, D]])
    dampers = [fm.Damper(f"c{axis}", mass, axis=axis, damping=c) for axis, c in zip("xy", damping, strict=True)]
    pressing = fm.normal.Spring(axis="y", stiffness=K, preload=10.0)
    lining = fm.Contact("lining", mass, belt, law=fm.laws.Coulomb(mu_s=2.0, mu_k=mu), normal_force=pressing)
    return fm.Scene("two modes", [mass, belt, structure, *dampers, lining])


def by_hand(mu, damping=(0.0, 0.0), k=K):
    """Eigenvalues (4,) and vectors of the same, written down anew."""
    stiffness = np.array([[A, B - mu * k], [B, D + k]])
    return np.linalg.eig(np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -np.diag(damping)]]))


def study(scene, **options):
    return fm.squeal.study(scene, progress=False, **options)


@pytest.fixture(scope="module")
def damped():
    return study(two_modes(damping=(0.03, 0.2)), over={MU: np.linspace(0.0, 1.4, 8), PRESS: [1.2, K, 1.5]})


def test_the_map_and_the_modes_are_those_of_numpy(damped):
    for i, mu in enumerate(damped.values[0]):
        for j, k in enumerate(damped.values[1]):
            expected = by_hand(mu, (0.03, 0.2), k)[0]
            assert damped.map.growth[i, j] == pytest.approx(expected.real.max(), abs=1e-13)
            found = damped.eigenvalues[i, j]
            np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(expected[expected.imag > 0]), atol=1e-12)
    assert damped.shapes.shape == (8, 3, 2, 2)


@pytest.mark.parametrize("values", [np.linspace(0.0, 1.0, 5), np.linspace(1.0, 0.0, 4)])
def test_thresholds_in_closed_form(values):
    stiffnesses = np.array([1.2, K, 1.5])
    found = study(two_modes(), over={MU: values, PRESS: stiffnesses})
    expected = ((A - D - stiffnesses) ** 2 / (4.0 * B) + B) / stiffnesses
    assert [t.value for t in found.thresholds] == pytest.approx(expected, rel=1e-12)
    assert [t.at[PRESS] for t in found.thresholds] == pytest.approx(stiffnesses)
    assert all(t.kind == "flutter" and t.unstable_above for t in found.thresholds)
    assert found.thresholds[1].frequency == pytest.approx(np.sqrt(2.0), rel=1e-9)
    c = 0.1
    (one,) = study(two_modes(damping=(c, c)), over={MU: values}).thresholds
    assert one.value == pytest.approx(0.75 * (1 + 2 * c**2), abs=1e-10)


def test_modes_keep_their_identity_over_two_parameters():
    """Springs along and across the slip: modes cross without seeing one another."""
    puck, belt = fm.Body("puck", mass=1.0, axes="xy"), fm.Driven("belt", velocity={"x": 1.0})
    springs = [fm.Spring(f"k{c}", puck, axis=c, stiffness=4.0) for c in "xy"]
    sole = fm.Contact("sole", puck, belt, law=fm.laws.Coulomb(mu_s=0.1), normal_force=1.0)
    kx, ky = np.linspace(1.0, 9.0, 9), np.linspace(2.1, 7.9, 5)
    found = study(fm.Scene("puck", [puck, belt, *springs, sole]), over={"kx.stiffness": kx, "ky.stiffness": ky})
    assert found.eigenvalues.shape == (9, 5, 2)
    along = int(np.argmax(np.abs(found.shapes[0, 0, :, 0])))
    assert found.eigenvalues[:, :, along].imag == pytest.approx(np.sqrt(kx)[:, None] * np.ones(5))
    assert found.eigenvalues[:, :, 1 - along].imag == pytest.approx(np.sqrt(ky - 0.05**2) * np.ones((9, 1)))


@pytest.mark.parametrize("mu", [0.3, 0.8, 1.3])
def test_shares_of_growth(damped, mu):
    found = damped.feed({MU: mu, PRESS: K})
    values, vectors = by_hand(mu, (0.03, 0.2))
    k = int(np.argmax(values.real))
    x = vectors[:2, k if values[k].imag > 0 else int(np.argmin(abs(values - values[k].conj())))]
    mass = np.vdot(x, x).real
    assert found.growth == pytest.approx(values.real.max(), abs=1e-13)
    assert sum(found.parts.values()) == pytest.approx(found.growth, abs=1e-13)
    assert sum(p.share for p in found.pairs) + found.velocity == pytest.approx(found.growth, abs=1e-13)
    # a damper takes c |v|^2 of twice the kinetic energy
    for name, c, part in (("cx", 0.03, x[0]), ("cy", 0.2, x[1])):
        assert found.parts[name] == pytest.approx(-0.5 * c * abs(part) ** 2 / mass, rel=1e-9)
    assert set(found.parts) == {"lining", "cx", "cy"}
    assert len(found.pairs) == 1


def test_what_feeds_is_what_friction_brings_in_a_run():
    """Work of friction and of dampers on the growing oscillation, integrated in time."""
    scene, mu = two_modes(mu=1.3, damping=(0.03, 0.2)), 1.3
    found = study(scene, over={MU: [0.5, mu]}).feed()
    steady = fm.analysis.steady_sliding(scene)
    push = {"mass.x": 1e-4}
    sol = fm.simulate(scene, t_end=30.0, rtol=1e-11, initial=steady.initial(push=push))
    flows = fm.analysis.modal_energy(sol, around=steady)
    values, vectors = by_hand(mu, (0.03, 0.2))
    k = int(np.argmax(values.real + 1e-9 * values.imag))
    x, value = vectors[:2, k], values[k]
    # mean powers over four periods, once the decaying mode is gone, less the growth of the motion
    middle = 0.5 * (flows.t[1:] + flows.t[:-1])
    late = (middle > 12.0) & (middle <= 12.0 + 4 * 2 * np.pi / value.imag)
    weight = np.exp(-2 * value.real * middle[late])
    friction, damping = (weight @ np.diff(part.sum(axis=0))[late] for part in (flows.friction, flows.damping))
    mass = np.vdot(x, x).real
    # friction is not conservative and not without: what its symmetric part stores grows with the motion
    stored = value.real * (x.conj() @ np.array([[0.0, -mu * K], [0.0, 0.0]]) @ x).real
    brought = -0.5 * (stored - value.imag * 2.0 * value.imag * mass * found.parts["lining"])
    taken = -(abs(value) ** 2) * mass * (found.parts["cx"] + found.parts["cy"])
    assert friction / damping == pytest.approx(brought / taken, rel=2e-3)


def test_states_of_laws_feed_too():
    scene = two_modes(mu=0.9)
    law = fm.laws.LuGre(sigma0=200.0, sigma1=0.3, sigma2=0.02, mu_s=1.1, mu_k=0.9, v_s=0.8)
    scene = scene.replace("lining", law=law)
    found = study(scene, over={"lining.law.sigma2": [0.02, 0.03]}).feed({"lining.law.sigma2": 0.02})
    assert abs(found.growth) > 1e-3
    assert sum(found.parts.values()) == pytest.approx(found.growth, abs=1e-10)
    assert sum(p.share for p in found.pairs) + found.velocity == pytest.approx(found.growth, abs=1e-10)


def test_derivatives_against_differences(damped):
    at = {MU: 1.2, PRESS: K}
    found = damped.derivatives(at, names=[MU, PRESS, "cy.damping", "mass.mass"])

    def eigenvalue(mu=1.2, c=0.2, k=K):
        values = by_hand(mu, (0.03, c), k)[0]
        values = values[values.imag > 0.0]
        return values[np.argsort(-values.real)]

    h = 1e-6
    for name, p, change in ((MU, 1.2, "mu"), (PRESS, K, "k"), ("cy.damping", 0.2, "c")):
        high, low = (eigenvalue(**{change: p + s * h}) for s in (1, -1))
        i = found.names.index(name)
        assert found.slopes[i] == pytest.approx(p * (high[0] - low[0]) / (2 * h), rel=1e-6, abs=1e-8)
        split = [(((e[0] - e[1]) / 2) ** 2).real for e in (high, low)]
        assert found.apart[i] == pytest.approx(-p * (split[0] - split[1]) / (2 * h), rel=1e-6, abs=1e-8)
    assert found.partner == pytest.approx(eigenvalue()[1])
    assert "mass.mass" in str(found)


def test_derivatives_of_thresholds_in_closed_form():
    undamped = study(two_modes(), over={MU: [0.5, 1.0]})
    at = undamped.thresholds[0]
    found = undamped.derivatives(at, names=[PRESS, MU])
    k, a, b, d = sympy.symbols("k a b d")
    critical = ((a - d - k) ** 2 / (4 * b) + b) / k
    slope = float((k * critical.diff(k)).subs({k: K, a: A, b: B, d: D}))
    assert np.isnan(found.slopes).all()  # the two modes have met: each alone has no derivative
    assert found.threshold == pytest.approx([slope, -0.75], rel=1e-5)
    c = 0.1  # 0.75 (1 + 2 c^2) for c of both
    damped = study(two_modes(damping=(c, c)), over={MU: [0.5, 1.0]})
    both = damped.derivatives(damped.thresholds[0], names=["cx.damping", "cy.damping"])
    assert both.threshold.sum() == pytest.approx(0.75 * 4 * c**2, rel=1e-6)
    assert undamped.derivatives(at).names == ("mass.mass", "belt.velocity.x", "structure.scale", "lining.law.mu_s", MU,
                                              "lining.normal_force.preload", PRESS)  # fmt: skip


def test_growth_in_a_run():
    found = study(two_modes(damping=(0.03, 0.2)), over={MU: [0.5, 1.3]}).growth()
    expected = by_hand(1.3, (0.03, 0.2))[0]
    expected = expected[np.argmax(expected.real + 1e-9 * expected.imag)]
    assert found.measured == pytest.approx(expected, rel=1e-4)
    assert found.difference < 1e-4
    assert not found.solution.events


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rayleigh(fm.FrictionLaw):
    """Falls with speed about ``v`` and rises again."""

    a: float
    b: float
    v: float

    def define_coefficient(self, r):
        return 1 - self.a * (r - self.v) + self.b * (r - self.v) ** 3


def test_amplitude_of_the_limit_cycle_in_closed_form():
    """x'' + x = a x' - b x'^3 with a small: speed 2 sqrt(a/(3 b)), period 2 pi (1 + a^2/16)."""
    a, b, v = 0.02, 0.5, 1.0
    mass, belt = fm.Body("mass", mass=1.0), fm.Driven("belt", velocity={"x": v})
    sole = fm.Contact("sole", mass, belt, law=Rayleigh(a=a, b=b, v=v), normal_force=1.0)
    scene = fm.Scene("Rayleigh", [mass, belt, fm.Spring("k", mass, axis="x", stiffness=1.0), sole])
    found = study(scene, over={"sole.law.a": [-0.02, a]})
    (threshold,) = found.thresholds
    assert threshold.value == pytest.approx(0.0, abs=1e-9)
    assert threshold.kind == "self-excitation"
    end = found.saturation()
    assert end.settled
    assert end.cycle is not None
    assert end.amplitude["mass.x"] == pytest.approx(2 * np.sqrt(a / (3 * b)), rel=2e-4)
    assert end.cycle.period == pytest.approx(2 * np.pi * (1 + a**2 / 16), rel=1e-5)
    sizes = found.amplitudes("mass.x")
    assert sizes[0, 0] == 0.0
    assert sizes[1, 0] == pytest.approx(2 * np.sqrt(a / (3 * b)), rel=0.02)


def test_probability_in_closed_form():
    asked = study(two_modes(), over={MU: [0.5, 0.8]})
    found = asked.uncertainty({MU: (0.6, 0.9), "lining.normal_force.preload": 0.1}, indices=True, samples=64)
    assert found.probability == pytest.approx(0.5, abs=0.01)
    assert found.probability_error < 0.01
    s = np.sqrt(4 * 0.825 / 3 - 1)  # 1/4 of the samples lie above mu = 0.825
    assert found.quantile(0.75) == pytest.approx(np.sqrt(-2 + 1j * s).real, rel=0.02)
    assert found.first[0] == pytest.approx(1.0, abs=0.05)  # the load does not matter
    assert found.total[1] == pytest.approx(0.0, abs=1e-9)
    again = asked.uncertainty({MU: (0.6, 0.9), "lining.normal_force.preload": 0.1}, samples=64)
    np.testing.assert_array_equal(again.growth, found.growth)
    assert asked.uncertainty({MU: 0.1}, {MU: 0.75}).probability == pytest.approx(0.5, abs=0.02)


def test_which_parameters_matter(tmp_path):
    pytest.importorskip("SALib")
    from scipy import stats

    from fricmb.squeal._screening import screening

    plane = {"a": stats.uniform(0.0, 2.0), "b": stats.norm(1.0, 0.1), "c": stats.uniform(0.0, 1.0)}
    found = screening(plane, {}, 6, 1, lambda p: 3.0 * p[:, 0] - 5.0 * p[:, 2])
    np.testing.assert_allclose(found.effects, [6.0, 0.0, 5.0], atol=1e-12)  # over the whole of each distribution
    np.testing.assert_allclose(found.scatter, 0.0, atol=1e-12)
    asked = study(two_modes(), over={MU: [0.8, 0.9]})
    found = asked.screening({MU: (0.8, 0.9), "lining.normal_force.preload": 0.1}, trajectories=4)
    assert found.effects[1] == pytest.approx(0.0, abs=1e-9)  # the load does not matter
    rise = by_hand(0.9)[0].real.max() - by_hand(0.8)[0].real.max()
    assert found.effects[0] == pytest.approx(rise, rel=0.2)
    assert str(found).splitlines()[1].startswith(MU)
    asked.report(tmp_path / "report.html")
    assert "Which parameters matter" in (tmp_path / "report.html").read_text()
    assert asked.tables()["screening"][1][0][0] == MU


def test_a_study_goes_on_on_a_cluster(tmp_path):
    """What one client has kept, another need not make; results are those of this process."""
    distributed = pytest.importorskip("dask.distributed")
    over = {MU: [0.5, 0.8, 0.9]}
    plain = study(two_modes(), over=over)
    with distributed.Client(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None) as client:
        study(two_modes(), over={MU: [0.5, 0.8]}, workers=client, store=tmp_path)
        kept = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
        again = study(two_modes(), over=over, workers=client, store=tmp_path)
    np.testing.assert_array_equal(again.eigenvalues, plain.eigenvalues)
    assert kept


def test_a_study_goes_on_where_it_stopped(tmp_path, monkeypatch):
    over = {MU: [0.5, 0.8]}
    first = study(two_modes(), over=over, store=tmp_path)
    made = []
    monkeypatch.setattr(Places, "run", lambda self, values, run=Places.run: made.append(values) or run(self, values))
    again = study(two_modes(), over=over, store=tmp_path)
    assert made == []
    np.testing.assert_array_equal(again.eigenvalues, first.eigenvalues)
    more = study(two_modes(), over={MU: [0.5, 0.8, 0.9]}, store=tmp_path)
    assert made == [{MU: 0.9}]
    assert more.map.growth[2, 0] == pytest.approx(by_hand(0.9)[0].real.max())
    study(two_modes(), over=over, highest=5.0, store=tmp_path)
    assert len(made) == 3


def test_places_without_sliding_are_told():
    scene = two_modes(mu=0.9)
    found = study(scene, over={"belt.velocity.x": [-1.0, -0.5, 0.0]})
    assert list(found.failed) == [(0.0,)]
    assert "does not slide" in found.failed[0.0,]
    assert np.isnan(found.map.growth[2, 0])
    assert np.isnan(found.steady("lining")["normal"][2, 0])
    assert found.steady("lining")["slip"][:2, 0] == pytest.approx([1.0, 0.5])
    assert "no steady sliding at 1 places" in str(found)
    assert found.worst == {"belt.velocity.x": -1.0}
    with pytest.raises(fm.FricmbError, match="does not slide"):
        study(two_modes(speed=0.0), over={MU: [0.1, 0.2]})


def test_the_line_of_a_picture_passes_through_the_thresholds(damped):
    """Places were 0.2 apart, and the line between colours was drawn as much as half of that away."""
    shown = damped.plot().axes[0].collections
    border = next(c for c in shown if len(c.get_edgecolor()) and c.get_linewidth()[0] == 1.4)
    line = np.concatenate([path.vertices for path in border.get_paths()])
    for threshold in damped.thresholds:
        at = np.array([threshold.at[PRESS], threshold.value])
        assert np.abs(line - at).sum(axis=1).min() < 0.01


def test_the_report_needs_no_network(tmp_path, damped):
    damped.answered.clear()
    damped.feed()
    damped.derivatives(damped.thresholds[0])
    damped.uncertainty({MU: 0.1})
    written = damped.write(tmp_path)
    page = (tmp_path / "report.html").read_text()
    assert not re.search(r"(src|href)=\"(?!data:)", page)
    assert "url(" not in page
    assert "<script" not in page
    for title in ("What feeds the mode", "Which parameters calm it", "How sure that is", "thresholds"):
        assert title in page
    names = {path.name for path in written}
    assert names >= {"map.csv", "modes.csv", "contacts.csv", "thresholds.csv", "feed.csv", "uncertainty.csv"}
    with (tmp_path / "map.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 24
    assert float(rows[-1]["largest growth rate"]) == damped.map.growth[-1, -1]
    with (tmp_path / "thresholds.csv").open() as file:
        assert float(next(csv.DictReader(file))[MU]) == damped.thresholds[0].value
    assert damped.plot().axes


def test_on_the_command_line(tmp_path, capsys):
    over = ["--over", "sole.law.mu_s=0:1:5"]  # without friction it slides, too
    assert main(["squeal", "minimal_flutter", *over, "--out", str(tmp_path), "--growth", "--quiet"]) == 0
    assert (tmp_path / "report.html").stat().st_size > 10_000
    assert "no steady sliding" not in (tmp_path / "report.html").read_text()
    assert (
        main(["squeal", "minimal_flutter", *over, "--out", str(tmp_path), "--uncertain", "sole.law.mu_s=0.7:0.8"]) == 0
    )
    assert "flutter above sole.law.mu_s = 0.75" in capsys.readouterr().out
    for wrong, words in (
        ([], "--over is missing"),
        (["--over", "sole.law.mu_s=0:1"], "expected NAME=FIRST:LAST:COUNT"),
        (["--over", "sole.law.nu=0,1"], "unknown parameter in over"),
        ([*over, "--uncertain", "sole.law.mu_s=a"], "expected NAME=SHARE"),
        ([*over, "--speed", "mass.x"], "expected NAME=NUMBER"),
    ):
        assert main(["squeal", "minimal_flutter", *wrong, "--out", str(tmp_path)]) == 2
        assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"over": {}}, "over must be a dict of one or two names"),
        ({"over": [MU]}, "over must be a dict of one or two names"),
        ({"over": {"nu": [1.0]}}, "unknown parameter in over 'nu'"),
        ({"over": {MU: [1.0, 0.0, 0.5]}}, "values must be one or more finite numbers, rising or falling"),
        ({"over": {MU: [0.1]}, "highest": -1.0}, "highest must be positive"),
    ],
)
def test_what_cannot_be_is_refused(options, words):
    with pytest.raises(fm.FricmbError, match=words):
        study(two_modes(), **options)


def test_a_scene_in_which_nothing_slides_is_refused():
    mass = fm.Body("mass", mass=1.0)
    spring = fm.Spring("spring", mass, axis="x", stiffness=1.0)
    with pytest.raises(fm.FricmbError, match="nothing slides in scene 'free': it has no contact"):
        study(fm.Scene("free", [mass, spring]), over={"spring.stiffness": [1.0, 2.0]})


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda s: s.feed({"nu": 1.0}), "unknown parameter in at 'nu'"),
        (lambda s: s.feed(3.0), "at must be a dict"),
        (lambda s: s.derivatives(names=["nu"]), "unknown parameter in names 'nu'"),
        (lambda s: s.steady("linin"), "unknown contact 'linin'; did you mean 'lining'"),
        (lambda s: s.amplitudes("mass.z"), "unknown degree of freedom 'mass.z'"),
        (lambda s: s.line("nu"), "unknown parameter of the study 'nu'"),
        (lambda s: s.growth(t_end=3.0), "t_end"),
        (lambda s: s.uncertainty({}), "distributions must be a dict"),
        (lambda s: s.uncertainty({MU: "x"}), "relative standard deviation"),
        (lambda s: s.uncertainty({MU: 0.1}, samples=3), "power of 2"),
        (lambda s: s.uncertainty({"nu": 0.1}), "unknown parameter in distributions 'nu'"),
    ],
)
def test_questions_that_cannot_be_are_refused(damped, ask, words):
    with pytest.raises(fm.FricmbError, match=words):
        ask(damped)


def test_a_scene_with_joints_has_a_map():
    """The wobbling disc of a brake, beside its eigenvalues one by one."""
    scene = fm.models.wobbling_disc_brake(kick=0.0)
    found = study(scene, over={"mu": [0.1, 0.5], "speed": [40.0, 50.0]})
    expected = fm.analysis.steady_sliding(scene.with_parameters({"mu": 0.5, "speed": 40.0})).eigenpairs()[0]
    assert found.map.growth[1, 0] == pytest.approx(expected.real.max(), rel=1e-9)
    assert found.failed == {}
    for ask in (found.feed, found.derivatives, found.growth, found.saturation):
        with pytest.raises(fm.FricmbError, match="joints"):
            ask()


@needs_real
@pytest.mark.slow
def test_industrial_brake():
    """4669 degrees of freedom; growth rates and the critical value are those of the whole."""
    scene = industrial_brake()
    found = study(scene, over={"kappa": np.linspace(0.0, 1.0, 13)})
    place = found._grid[-1][0]
    growing = np.sort_complex(place.eigenvalues[place.grows])
    np.testing.assert_allclose(growing.real, np.real(GROWING), rtol=1e-3)
    np.testing.assert_allclose(growing.imag, np.imag(GROWING), rtol=1e-6)
    first = found.thresholds[0]
    assert first.value == pytest.approx(0.404563081, rel=1e-5)
    assert first.frequency / (2 * np.pi) == pytest.approx(2781.626564, rel=1e-6)
    feed = found.feed()
    assert sum(feed.parts.values()) == pytest.approx(feed.growth, rel=1e-6)
