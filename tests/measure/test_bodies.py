"""Bodies from tests: against a structure whose modes and responses are known in closed form."""

from dataclasses import replace

import numpy as np
import pytest

import fricmb as fm
from tests.real import needs_real, real

# a free beam's lowest bending modes, by any shapes that differ
OMEGA = 2 * np.pi * np.array([50.0, 137.0, 268.0])
ZETA = np.array([0.004, 0.002, 0.003])
MASSES = np.array([0.4, 1.3, 0.7])
SHAPES = np.array([[1.0, -0.6, 0.5], [0.3, 0.7, -0.9], [-0.5, 0.4, 0.8]])  # nodes 4, 7, 9 along z
NODES = np.array([4, 7, 9])
F = np.arange(5.0, 400.0, 0.25)


def response(a, b, kind="accelerance", f=F):
    """Accelerance of node a over a force on node b, with a stiff remainder above."""
    s = 2j * np.pi * f[:, None]
    modal = SHAPES[a] * SHAPES[b] / MASSES / (s**2 + 2 * ZETA * OMEGA * s + OMEGA**2)
    power = {"receptance": 0, "mobility": 1, "accelerance": 2}[kind]
    return modal.sum(axis=1) * s[:, 0] ** power


def frf(a, b, kind="accelerance", **changes):
    held = {"f": F, "values": response(a, b, kind), "node": int(NODES[a]), "axis": "z", "kind": kind}
    return fm.measure.Frf(**(held | {"reference": int(NODES[b]), "reference_axis": "z"} | changes))


def modes(masses=MASSES, factor=1.0):
    shapes = np.full((3, 3, 3), np.nan)
    shapes[:, :, 2] = (SHAPES * factor).T
    return fm.measure.Modes(frequencies=OMEGA, damping_ratios=ZETA, nodes=NODES, shapes=shapes, masses=masses)


def body(**changes):
    given = {"modes": modes(), "points": {"tip": 4, "root": 9}, "axes": "z"} | changes
    return fm.ModalBody.from_test("casting", **given)


@pytest.mark.parametrize("kind", ["receptance", "mobility", "accelerance"])
def test_responses_of_the_body_are_those_of_the_structure(kind):
    np.testing.assert_allclose(body().frf("root.z", "tip.z", F, kind), response(2, 0, kind), rtol=1e-10)
    np.testing.assert_allclose(body().frf("root.-z", "tip.z", F, kind), -response(2, 0, kind))


def test_masses_by_a_driving_point():
    # shapes of any size: the driving point says what they are
    found = body(modes=modes(masses=np.zeros(3), factor=np.array([3.0, 0.2, -7.0])), scale=frf(1, 1))
    np.testing.assert_allclose(found.frf("root.z", "tip.z", F), response(2, 0), rtol=1e-6)
    with pytest.raises(fm.SceneError, match=r"mode 1 at 50 Hz has no modal mass; give scale="):
        body(modes=modes(masses=np.zeros(3)))


def test_a_driving_point_that_is_none_is_refused():
    bare = modes(masses=np.zeros(3))
    with pytest.raises(
        fm.SceneError, match="must be of a driving point; it is motion of node 4 z over a force on node 7 z"
    ):
        body(modes=bare, scale=frf(0, 1))
    # labelled as one, and the signs of its residues say otherwise
    wrong = frf(0, 1, node=7)
    with pytest.raises(
        fm.SceneError, match=r"is labelled as of a driving point, node 7 z, but residues at 137, 268 Hz"
    ):
        body(modes=bare, scale=wrong)
    with pytest.raises(fm.SceneError, match="scale must be a Frf"):
        body(modes=bare, scale=3.0)


def test_modes_from_responses():
    rng = np.random.default_rng(5)
    frfs = []
    for i in range(3):
        clean = frf(i, 0)
        noise = 1e-3 * np.abs(clean.values) * (rng.standard_normal(F.size) + 1j * rng.standard_normal(F.size))
        frfs.append(replace(clean, values=clean.values + noise))
    found = fm.measure.identify(frfs)
    np.testing.assert_allclose(found.frequencies, OMEGA, rtol=2e-5)
    np.testing.assert_allclose(found.damping_ratios, ZETA, rtol=0.02)
    # of unit modal mass, by the driving point among them
    np.testing.assert_allclose(np.abs(found.shapes[:, :, 2]), np.abs(SHAPES / np.sqrt(MASSES)).T, rtol=0.02)
    built = fm.ModalBody.from_test("casting", found, points={"tip": 4, "root": 9}, axes="z")
    comparison = built.compare([frf(2, 0)], points={"tip": 4, "root": 9})
    assert comparison.r2[0] > 0.99


def test_comparison_finds_pairs_and_differences():
    swapped = [2, 0, 1]
    shapes = np.full((3, 3, 3), np.nan)
    shapes[:, :, 2] = -2.5 * SHAPES.T[swapped]
    test = fm.measure.Modes(
        frequencies=1.02 * OMEGA[swapped], damping_ratios=ZETA[swapped] - 0.001, nodes=NODES, shapes=shapes,
        masses=np.ones(3),
    )  # fmt: skip
    built = body(points={"a_4": 4, "b_7": 7, "c_9": 9})
    found = built.compare(test)
    assert found.pairs == ((0, 0), (1, 1), (2, 2))
    np.testing.assert_allclose(np.diag(found.mac), 1.0)
    np.testing.assert_allclose(found.frequency_differences, 1 / 1.02 - 1)
    np.testing.assert_allclose(found.damping_differences, 0.001)
    # in closed form
    a, b = SHAPES[:, 0], SHAPES[:, 1]
    assert found.mac[0, 1] == pytest.approx((a @ b) ** 2 / ((a @ a) * (b @ b)))
    assert "137" not in str(found)
    assert "139.74" in str(found)


def test_comparison_of_responses_and_pictures():
    found = body().compare(
        fm.measure.Measured(frfs=(frf(2, 0), frf(1, 0)), modes=modes()), points={"tip": 4, "root": 9}
    )
    assert len(found.responses) == 1
    assert found.r2[0] == pytest.approx(1.0, abs=1e-9)
    assert found.plot.mac().axes
    assert found.plot.responses().axes
    stiffer = body(modes=replace(modes(), frequencies=1.1 * OMEGA)).compare(frf(2, 0), points={"tip": 4, "root": 9})
    assert stiffer.r2[0] < 0.9
    with pytest.raises(fm.SceneError, match="no response of the test lies between two of its points"):
        body().compare(frf(1, 1), points={"tip": 4, "root": 9})
    with pytest.raises(fm.SceneError, match="points must say which node"):
        body().compare(frf(1, 1))


def test_a_body_of_a_test_runs_in_a_scene():
    built = body()
    scene = fm.Scene("casting", [built, fm.Force("push", built.point("tip"), axis="z", value=1.0)])
    steady = fm.analysis.steady_sliding(scene)
    assert steady.position("casting.mode1") == pytest.approx(SHAPES[0, 0] / (MASSES[0] * OMEGA[0] ** 2))


def test_what_cannot_be_is_refused():
    with pytest.raises(fm.FricmbError, match=r"unknown node of the modes 5; .*'4'"):
        body(points={"tip": 5})
    with pytest.raises(fm.SceneError, match="node 4 was not measured along 'x'"):
        body(axes="xz")
    with pytest.raises(fm.SceneError, match="modes must be Modes"):
        body(modes=[1, 2])
    crooked = modes()
    crooked = replace(crooked, shapes=crooked.shapes * np.exp(1j * np.array([0.0, 0.5, 1.2]))[:, None])
    with pytest.raises(fm.SceneError, match=r"mode \d at .* Hz is complex"):
        body(modes=crooked)
    turned = replace(modes(), shapes=modes().shapes * np.exp(0.7j))
    np.testing.assert_allclose(body(modes=turned).frf("root.z", "tip.z", F), response(2, 0), rtol=1e-9)
    for wrong, words in (
        (("root.x", "tip.z", F), "axis"), (("rot.z", "tip.z", F), "unknown point"),
        (("root.z", "tip.z", [-1.0]), ">= 0"),
        (("root.z", "tip.z", F, "inertance"), "kind must be one of"),
    ):  # fmt: skip
        with pytest.raises(fm.FricmbError, match=words):
            body().frf(*wrong)


@needs_real
def test_measured_accelerances():
    """Of three points; the one that is labelled as a driving point is none."""
    frfs = []
    for i in (1, 2, 3):
        (found,) = fm.measure.read(real(f"meas_point_{i}.txt"), step=1.0).frfs
        frfs.append(replace(found, node=1, axis="z", reference=i, reference_axis="z", kind="accelerance"))
    found = fm.measure.identify(frfs, band=(20.0, 1000.0))
    np.testing.assert_allclose(found.hertz, [51.52, 142.18, 278.66, 460.40, 687.17, 958.53], atol=0.02)
    assert 1.2e-4 < found.damping_ratios.min() < found.damping_ratios.max() < 6.5e-4
    assert np.isnan(found.masses).all()
    with pytest.raises(fm.SceneError, match=r"but residues at 142\.\d+, 460\.\d+, 958\.\d+ Hz"):
        fm.ModalBody.from_test("casting", found, points={"p": 1}, axes="z", scale=frfs[0])


@needs_real
def test_universal_files_of_other_programs():
    pytest.importorskip("pyuff")
    simulated = fm.measure.read(real("NX_simulation_output.uff.gz"), format="uff")
    assert simulated.modes.hertz[0] == pytest.approx(23383.2)
    assert simulated.modes.masses[0] == 1.0
    assert simulated.units["length"] == 1000.0
    rig = fm.measure.read(real("TestLab_161_164_18_15_82.uff"))
    assert len(rig.points) == 36
    assert "Stator" in rig.lines
    (sine,) = fm.measure.read(real("binary8byte.uff")).signals
    assert (sine.name, sine.unit, sine.t.size) == ("sine 5 Hz", "g", 250)
    shapes = fm.measure.read(real("uff55_translation_rotation.uff")).modes
    assert shapes.shapes.shape == (1, 43, 6)
    assert np.isnan(shapes.masses).all()  # the file has 0


def test_modes_of_another_model_beside_the_matrices():
    """The results and the matrices in the examples of a library are of different runs."""
    examples = pytest.importorskip("ansys.mapdl.reader.examples")
    fe = fm.fe.read(examples.fullfile)
    with pytest.raises(fm.SceneError, match=r"do not belong to these matrices.*\d of \|K phi\| for mode \d at"):
        fe.check(modes=examples.rstfile)
