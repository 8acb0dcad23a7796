"""The suite as a whole: what is run, going on after an interruption, the report."""

import json

import pytest

import fricmb as fm
from fricmb.bench import Options, Own, Setting, Store, fingerprint, measure_cell, names, report
from fricmb.bench._orders import measure_order
from fricmb.bench._scenes import SCENES
from fricmb.bench._suite import Cell, about, measure_named, plan, run, titles

FREE = next(case for case in SCENES if case.name == "free")


def test_every_integrator_takes_part_in_every_scene_or_says_why():
    cells, refusals = plan(Options())
    for case in SCENES:
        for name in ("auto", *fm.integrators):
            tried = any((cell.case, cell.method) == (case.name, name) for cell in cells)
            refused = any((row["case"], row["method"]) == (case.name, name) and row["why"] for row in refusals)
            assert tried != refused, (case.name, name)
    assert len({cell.key for cell in cells}) == len(cells)
    assert {cell.case for cell in cells} == set(names())


def test_the_quick_suite_is_a_part_of_the_whole():
    quick, _ = plan(Options(quick=True))
    whole, _ = plan(Options())
    assert 20 < len(quick) < 0.2 * len(whole)
    assert {cell.family for cell in quick} == {"scene", "dae", "order", "size"}


def test_an_interrupted_suite_goes_on(tmp_path):
    """What is in the store is not measured again: here a cell that no measurement could give."""
    options = Options(quick=True, scenes=("akzo_nobel",))
    cells, _ = plan(options)
    store = Store(tmp_path / "cells.jsonl", fingerprint(options))
    marked = measure_named(cells[0]) | {"used": "marked"}
    store.put(cells[0].key, marked)
    seen = []
    result = run(options, Store(tmp_path / "cells.jsonl", fingerprint(options)), lambda *row: seen.append(row))
    assert [row["used"] for row in result["daes"]] == ["marked"] + [""] * (len(cells) - 1)
    assert seen[-1][:2] == (len(cells), len(cells))
    assert all(row["metrics"]["state"] < 1e-2 for row in result["daes"])
    json.dumps(result)


def test_the_report_needs_no_network_and_shows_failures():
    good = [measure_cell(FREE, Own("auto"), Setting(rtol=rtol)).as_dict() for rtol in (1e-4, 1e-8)]
    bad = {**good[0], "method": "other", "peer": True, "metrics": None, "seconds": None, "failure": "gave up <here>"}
    order = measure_order("bdf2-paper")
    sizes = [{"case": "chain", "method": "auto", "n": n, "seconds": 1e-5 * n, "events": 3} for n in (10, 100, 1000)]
    text = report({
        "about": about(Options()), "refusals": [], "cells": [*good, bad], "daes": [], "orders": [order], "sizes": sizes,
        "titles": titles(),
    })  # fmt: skip
    assert text.count("<svg") == 3
    assert "gave up &lt;here&gt;" in text
    assert "n^1.0" in text
    assert all(word not in text for word in ("<script", "src=", 'href="http', "@import", "url(http"))


def test_the_published_scheme_is_of_order_two():
    found = measure_order("bdf2-paper")
    assert found["order"] == pytest.approx(2.0, abs=0.05)


def test_cells_are_named_by_what_is_hard_in_them():
    cell = Cell("size", "chain", "auto", Setting(rtol=1e-4), 100)
    assert (cell.key, cell.row) == ("size/chain/auto/100", "size/chain/auto")
