"""Long runs: what is kept of them, and what a callback gets."""

import pickle

import numpy as np
import pytest

import fricmb as fm


@pytest.fixture(scope="module")
def brake():
    return fm.models.brake4dof("2")


GRID = np.linspace(0.0, 100.0, 201)
LONG = np.linspace(0.0, 3000.0, 1501)


@pytest.mark.parametrize("method", ["collocation", "bdf", "radau"])
def test_a_run_in_pieces_is_the_run(method, monkeypatch):
    belt = fm.models.belt_oscillator()
    whole = fm.simulate(belt, t_end=3000.0, rtol=1e-8, t_eval=LONG, method=method, dense=True)
    monkeypatch.setattr("fricmb._simulate._keep.MEMORY", 1e4)
    kept = fm.simulate(belt, t_end=3000.0, rtol=1e-8, t_eval=LONG, method=method)
    assert kept.t.tolist() == LONG.tolist()
    scale = np.abs(whole.q).max(axis=1, keepdims=True)
    assert (np.abs(kept.q - whole.q) / scale).max() < 1e-6
    assert [e.kind for e in kept.events] == [e.kind for e in whole.events]
    assert kept.energy.friction_loss == pytest.approx(whole.energy.friction_loss, rel=1e-6)
    assert abs(kept.energy.residual).max() < 1e-7
    # pieces start anew, with steps of their own
    assert kept.stats.n_steps >= 0.9 * whole.stats.n_steps
    with pytest.raises(fm.SceneError, match=r"kept.*dense=True"):
        kept(51.0)
    assert kept(200.0) == pytest.approx(np.concatenate((kept.q[:, 100], kept.v[:, 100])))


def test_pieces_go_on_save_and_pickle(brake, monkeypatch, tmp_path):
    monkeypatch.setattr("fricmb._simulate._keep.MEMORY", 1e4)
    kept = fm.simulate(brake, t_end=100.0, rtol=1e-8, t_eval=GRID, method="bdf")
    further = fm.simulate(brake, t_end=120.0, rtol=1e-8, initial=kept)
    straight = fm.simulate(brake, t_end=120.0, rtol=1e-8, t_eval=[120.0])
    assert further.q[:, -1] == pytest.approx(straight.q[:, -1], rel=1e-5, abs=1e-9)
    assert pickle.loads(pickle.dumps(kept)).q.tolist() == kept.q.tolist()
    kept.save(tmp_path / "kept")
    assert fm.Solution.load(tmp_path / "kept.npz").v.tolist() == kept.v.tolist()


def test_rows_alone_without_output_times(brake, monkeypatch):
    monkeypatch.setattr("fricmb._simulate._keep.SMALL", 1e4)
    kept = fm.simulate(brake, t_end=100.0, rtol=1e-8, method="bdf", dense=False)
    assert kept.t[0] == 0.0
    assert kept.t[-1] == 100.0
    assert (np.diff(kept.t) >= 0.0).all()
    assert sum(np.isin([e.t for e in kept.events], kept.t)) == len(kept.events)


def test_a_callback_gets_every_part(brake):
    parts = []
    last = fm.simulate(brake, t_end=100.0, rtol=1e-8, t_eval=GRID, chunk=30.0, on_chunk=parts.append)
    whole = fm.simulate(brake, t_end=100.0, rtol=1e-8, t_eval=GRID)
    assert last is parts[-1]
    assert [part.t_end for part in parts] == [30.0, 60.0, 90.0, 100.0]
    assert np.concatenate([part.t for part in parts]).tolist() == GRID.tolist()
    found = np.concatenate([part.q for part in parts], axis=1)
    assert found == pytest.approx(whole.q, rel=1e-6, abs=1e-8)
    assert [e.kind for part in parts for e in part.events] == [e.kind for e in whole.events]
    lost = sum(part.energy.friction_loss[-1] for part in parts)
    assert lost == pytest.approx(whole.energy.friction_loss[-1], rel=0.02)  # a part's last output is before its end


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"dense": 2}, "dense: got 2"),
        ({"chunk": 1.0}, "without on_chunk"),
        ({"chunk": -1.0, "on_chunk": print}, "chunk: got -1.0"),
        ({"on_chunk": 3}, "on_chunk: got 3"),
    ],
)
def test_bad_arguments_are_named(brake, arguments, message):
    with pytest.raises(fm.SceneError, match=message):
        fm.simulate(brake, t_end=1.0, **arguments)


def test_a_fixed_step_that_ends_beside_the_end(brake):
    # 0.005 summed up 4000 times is not 20
    sol = fm.simulate(brake, t_end=20.0, t_eval=[0.0, 20.0], method="bdf2-paper", step=5e-3)
    assert sol.t.tolist() == [0.0, 20.0]
    parts = []
    fm.simulate(brake, t_end=20.0, method="bdf2-paper", step=5e-3, chunk=10.0, on_chunk=parts.append)
    assert len(parts) == 2
