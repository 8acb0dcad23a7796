"""Results of sweeps as tables and pictures, against values put in by hand."""

import pickle

import matplotlib as mpl
import numpy as np
import pytest

import fricmb as fm

mpl.use("Agg")

VALUES = [{"k": k, "v": v} for k in (1.0, 2.0) for v in (0.1, 0.2, 0.3)]


def made(results, values=VALUES):
    return fm.SweepResults(results, values=values)


def numbers():
    return made([10.0 * run["k"] + run["v"] for run in VALUES])


def test_a_sweep_is_a_list_that_knows_its_values():
    scene = fm.models.belt_oscillator()
    runs = [{"belt.velocity.x": v} for v in (0.05, 0.1)]
    found = fm.sweep(
        scene, runs, t_end=1.0, reduce=lambda sol: 0.0, workers=1, progress=False, parameters={"spring.stiffness": 1.0}
    )
    assert isinstance(found, list)
    assert found.parameters == ("belt.velocity.x",)
    assert found.value("belt.velocity.x").tolist() == [0.05, 0.1]


def test_numbers_over_a_grid():
    (k, v), held = numbers().grid()
    assert (k.tolist(), v.tolist()) == ([1.0, 2.0], [0.1, 0.2, 0.3])
    assert held.tolist() == [[10.1, 10.2, 10.3], [20.1, 20.2, 20.3]]


def test_tables_have_a_row_a_run_and_say_what_failed():
    results = [{"a": 1.0, "b": 2.0}, fm.IntegrationError("stopped", t=1.0, reason="stopped"), {"a": 3.0, "b": 4.0}]
    found = made(results, [{"k": k} for k in (1.0, 2.0, 3.0)])
    table = found.to_pandas()
    assert list(table.columns) == ["k", "a", "b", "error"]
    assert table["a"].tolist()[::2] == [1.0, 3.0]
    assert np.isnan(table["a"][1])
    assert table["error"].tolist() == ["", "stopped", ""]
    assert found.failed == (1,)
    summed = found.to_pandas(total=lambda held: held["a"] + held["b"])
    assert summed["total"].tolist()[::2] == [3.0, 7.0]


def test_an_xarray_has_the_values_as_coordinates():
    data = numbers().to_xarray()
    assert data["result"].dims == ("k", "v")
    assert float(data["result"].sel(k=2.0, v=0.3)) == 20.3


def test_runs_missing_from_a_grid_are_empty():
    data = made([1.0, 2.0, 3.0], [{"k": 1.0, "v": 0.1}, {"k": 2.0, "v": 0.1}, {"k": 2.0, "v": 0.2}]).to_xarray()
    assert np.isnan(data["result"].sel(k=1.0, v=0.2))


def test_it_travels():
    again = pickle.loads(pickle.dumps(numbers()))
    assert again == numbers()
    assert again.values == numbers().values


def test_a_curve_and_a_map_show_the_numbers():
    failed = fm.IntegrationError("stopped", t=0.0, reason="stopped")
    found = made([1.0, failed, 3.0], [{"k": k} for k in (3.0, 2.0, 1.0)])
    (axes,) = found.plot(label="size").axes
    curve, mark = axes.lines
    assert curve.get_xdata().tolist() == [1.0, 2.0, 3.0]
    assert curve.get_ydata()[[0, 2]].tolist() == [3.0, 1.0]
    assert mark.get_xdata() == [2.0, 2.0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("k", "size")
    panel, bar = numbers().plot(label="size").axes
    (mesh,) = panel.collections
    assert np.asarray(mesh.get_array()).ravel().tolist() == [10.1, 20.1, 10.2, 20.2, 10.3, 20.3]
    assert (panel.get_xlabel(), panel.get_ylabel(), bar.get_ylabel()) == ("k", "v", "size")


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda found: found.value("kk"), "'kk'"),
        (lambda found: found.measure("reach"), "'reach'"),
        (lambda found: found.measure(lambda held: "x"), "expected a number"),
        (lambda found: found.plot(over="k"), "several runs have the same values of k"),
        (lambda found: made([{"a": 1.0, "b": 2.0}], [{"k": 1.0}]).plot(), "the results hold a, b"),
        (lambda found: made([], []).plot(lambda held: 1.0), "no parameter a value"),
        (lambda found: made([1.0], [{}]).plot(), "no parameter a value"),
        (lambda found: made([1.0], [{"a": 1.0, "b": 2.0, "c": 3.0}]).plot(), "got 3 parameters"),
    ],
)
def test_what_cannot_be_is_said(ask, said):
    with pytest.raises(fm.FricmbError, match=said):
        ask(numbers())
