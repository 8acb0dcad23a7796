import multiprocessing
import os
import pickle
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import pytest

import fricmb as fm

RUNS = [{"spring.stiffness": k} for k in (1.0, 4.0, 9.0, 16.0)]


def swinging(stiffness=1.0):
    """A mass on a spring, released at 1: x = cos(sqrt(k) t)."""
    mass = fm.Body("mass", mass=1.0, position={"x": 1.0})
    return fm.Scene("swinging", [mass, fm.Spring("spring", mass, axis="x", stiffness=stiffness)])


def last_position(sol):
    return sol["mass.x"][-1]


def process(sol):
    return os.getpid()


EXPECTED = np.cos(np.sqrt([1.0, 4.0, 9.0, 16.0]) * 2.0)


@pytest.mark.parametrize("workers", [1, 2])
def test_results_are_in_order(workers):
    found = fm.sweep(swinging(), RUNS, t_end=2.0, reduce=last_position, workers=workers, progress=False)
    np.testing.assert_allclose(found, EXPECTED, atol=1e-4)


def test_without_reduce_solutions_come_back_and_work():
    found = fm.sweep(swinging(), RUNS[:3], t_end=2.0, workers=2, progress=False, t_eval=[0.0, 2.0])
    for sol, run, expected in zip(found, RUNS, EXPECTED, strict=False):
        assert sol["mass.x"][-1] == pytest.approx(expected, abs=1e-4)
        assert sol.scene.parameters["spring.stiffness"] == run["spring.stiffness"]
        assert sol(1.0)[0] == pytest.approx(np.cos(run["spring.stiffness"] ** 0.5), abs=1e-4)
        assert np.abs(sol.energy.residual).max() < 1e-4


def test_runs_are_made_in_other_processes():
    found = fm.sweep(swinging(), RUNS, t_end=0.5, reduce=process, workers=2, progress=False)
    assert os.getpid() not in found
    assert fm.sweep(swinging(), RUNS, t_end=0.5, reduce=process, workers=1, progress=False) == [os.getpid()] * 4


def test_processes_that_are_spawned_and_threads():
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        found = fm.sweep(swinging(), RUNS[:2], t_end=2.0, reduce=np.shape, workers=pool, progress=False)
        assert found == [(), ()]
    with ThreadPoolExecutor(2) as pool:
        found = fm.sweep(swinging(), RUNS, t_end=2.0, reduce=last_position, workers=pool, progress=False)
    np.testing.assert_allclose(found, EXPECTED, atol=1e-4)


def test_parameters_that_all_runs_share():
    shared = {"mass.position.x": 2.0, "spring.stiffness": 4.0}
    found = fm.sweep(swinging(), [{}, RUNS[0]], t_end=2.0, parameters=shared, reduce=last_position, workers=1)
    np.testing.assert_allclose(found, [2 * np.cos(4.0), 2 * np.cos(2.0)], atol=1e-4)


@dataclass(frozen=True, kw_only=True)
class Falling(fm.FrictionLaw):
    """A coefficient that falls in proportion to the speed, below 0 in the end."""

    mu: float
    slope: float

    def define_coefficient(self, r):
        return self.mu - self.slope * r


def test_a_run_that_fails_leaves_its_error_in_its_place(tmp_path):
    scene = swinging()
    law = Falling(mu=0.1, slope=0.01)
    scene = fm.Scene("falling", [*scene.parts, fm.Contact("floor", scene["mass"], law=law, normal_force=1.0)])
    runs = [{"floor.law.slope": slope} for slope in (0.01, 0.5, 0.02)]
    given = {"t_end": 2.0, "progress": False, "store": tmp_path}
    for workers in (2, 1):
        good, bad, other = fm.sweep(scene, runs, workers=workers, **given)
        assert good.t_end == other.t_end == 2.0
        assert isinstance(bad, fm.IntegrationError)
        assert 0.1 < bad.t < 0.5
        assert bad.partial.t_end == pytest.approx(bad.t, rel=1e-3)
        assert bad.partial(0.1)[0] == pytest.approx(1.0, abs=0.01)


def test_a_wrong_run_is_told_before_anything_is_run(tmp_path):
    with pytest.raises(fm.SceneError, match=r"did you mean .spring.stiffness."):
        fm.sweep(swinging(), [RUNS[0], {"spring.stifness": 1.0}], t_end=2.0, store=tmp_path / "s", progress=False)
    assert not (tmp_path / "s").exists()
    with pytest.raises(fm.SceneError, match=r"runs: entry 1 is 3.0; expected a dict"):
        fm.sweep(swinging(), [RUNS[0], 3.0], t_end=2.0, progress=False)
    with pytest.raises(fm.SceneError, match="unknown signal in reduce 'mean'"):
        fm.sweep(swinging(), RUNS, t_end=2.0, reduce="mean", progress=False)
    for workers in (0, -1, 1.5, True, "all"):
        with pytest.raises(fm.SceneError, match="workers: got"):
            fm.sweep(swinging(), RUNS, t_end=2.0, workers=workers, progress=False)


def positive(sol):
    if sol["mass.x"][-1] < 0.0:
        raise ArithmeticError("a logarithm of nothing")
    return float(np.log(sol["mass.x"][-1]))


@pytest.mark.parametrize("workers", [1, 2, "threads"])
def test_an_error_of_reduce_costs_its_value_alone(tmp_path, capfd, workers):
    """It ended the sweep, and all results with it."""
    given = {"t_end": 2.0, "reduce": positive, "workers": workers, "progress": False, "store": tmp_path / str(workers)}
    found = fm.sweep(swinging(), RUNS, **given)
    bad = [i for i, x in enumerate(EXPECTED) if x < 0.0]
    assert found.failed == tuple(bad) == (0, 1, 3)
    assert found[2] == pytest.approx(np.log(EXPECTED[2]), abs=1e-3)
    for i in bad:
        assert isinstance(found[i], fm.IntegrationError)
        assert "reduce raised ArithmeticError: a logarithm of nothing" in found[i].reason
        assert "test_sweep.py, line" in found[i].reason
    said = capfd.readouterr().err
    assert said.count("a logarithm of nothing") == 2, "the first, and how many"
    assert "reduce raised in 3 of 4 runs" in said
    # it is tried again, as the code that it calls may be another by then
    again = fm.sweep(swinging(), RUNS, **given)
    assert again[2] == found[2]
    assert "reduce raised in 3 of 4 runs" in capfd.readouterr().err


def test_what_ends_a_sweep_leaves_its_results(monkeypatch):
    def ended(self, parameters):
        if parameters["spring.stiffness"] == 9.0:
            raise MemoryError
        return parameters["spring.stiffness"]

    monkeypatch.setattr("fricmb._sweep._workers.Job.run", ended)
    with pytest.raises(MemoryError) as stop:
        fm.sweep(swinging(), RUNS, t_end=2.0, workers=1, progress=False)
    assert stop.value.results == [1.0, 4.0, None, None]


def test_no_run_is_no_sweep():
    assert fm.sweep(swinging(), [], t_end=2.0, progress=False) == []


def test_a_bar_counts_the_runs(capsys):
    fm.sweep(swinging(), RUNS, t_end=0.1, workers=1)
    assert "4/4" in capsys.readouterr().err
    fm.sweep(swinging(), RUNS, t_end=0.1, workers=1, progress=False)
    assert capsys.readouterr().err == ""


def test_an_interrupted_sweep_goes_on_where_it_stopped(tmp_path, monkeypatch):
    made = []

    def counted(self, parameters):
        made.append(parameters)
        if len(made) == 3:
            raise KeyboardInterrupt
        return last_position(fm.simulate(self.scene, parameters=parameters, **self.options))

    monkeypatch.setattr("fricmb._sweep._workers.Job.run", counted)

    def sweep(scene=None, **given):
        options = {"t_end": 2.0, "reduce": last_position, "workers": 1, "store": tmp_path / "runs", "progress": False}
        return fm.sweep(scene or swinging(), RUNS, **{**options, **given})

    with pytest.raises(KeyboardInterrupt):
        sweep()
    found = sweep()
    np.testing.assert_allclose(found, EXPECTED, atol=1e-4)
    assert made == [*RUNS[:3], *RUNS[2:]]
    assert sweep() == found
    assert len(made) == 5
    sweep(t_end=3.0)
    sweep(scene=swinging().with_parameters({"mass.mass": 2.0}))
    sweep(reduce=process)
    assert len(made) == 5 + 3 * 4


def test_a_store_keeps_solutions(tmp_path):
    given = {"t_end": 2.0, "workers": 1, "store": tmp_path, "progress": False}
    first, second = fm.sweep(swinging(), RUNS[:2], **given), fm.sweep(swinging(), RUNS[:2], **given)
    np.testing.assert_array_equal(first[1].q, second[1].q)
    np.testing.assert_array_equal(first[1](0.3), second[1](0.3))
    assert second[0].stats == first[0].stats


SCRIPT = """
import fricmb as fm
mass = fm.Body("mass", mass=1.0, position={"x": 1.0})
scene = fm.Scene("swinging", [mass, fm.Spring("spring", mass, axis="x", stiffness=1.0),
                              fm.Contact("floor", mass, law=fm.laws.Coulomb(mu_s=0.1), normal_force=1.0)])
def reduce(sol):
    return float(sol["mass.x"][-1])
if __name__ == "__main__":
    import multiprocessing
    multiprocessing.set_start_method("spawn")
    print(fm.sweep(scene, [{"spring.stiffness": 1.0}, {"spring.stiffness": 4.0}], t_end=3.141592653589793,
                   reduce=reduce, workers=2, progress=False))
"""


@pytest.mark.slow
def test_processes_start_together_on_an_empty_cache(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    caches = {"NUMBA_CACHE_DIR": str(tmp_path / "numba"), "FRICMB_CACHE_DIR": str(tmp_path / "fricmb")}
    result = subprocess.run(
        [sys.executable, tmp_path / "script.py"], capture_output=True, text=True, check=True, env=os.environ | caches
    )
    first, second = eval(result.stdout)
    assert first == pytest.approx(-0.8, abs=1e-5)
    assert second == pytest.approx(0.9, abs=1e-5)


def test_a_dask_cluster():
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        found = fm.sweep(swinging(), RUNS, t_end=2.0, reduce=last_position, workers=client, progress=False)
    np.testing.assert_allclose(found, EXPECTED, atol=1e-4)


def test_a_failed_run_pickles_into_its_place():
    error = fm.IntegrationError("stopped", t=1.0, reason="why", partial=None)
    again = pickle.loads(pickle.dumps(error))
    assert (again.t, again.reason, again.partial) == (1.0, "why", None)


@pytest.mark.parametrize("runs", [None, 3, "k", {"belt.velocity.x": 0.1}])
def test_runs_are_a_list(runs):
    with pytest.raises(fm.SceneError, match=r"runs: got .*; expected a list of dicts"):
        fm.sweep(fm.models.belt_oscillator(), runs, t_end=1.0, progress=False)
