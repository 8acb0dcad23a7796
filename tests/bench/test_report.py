"""The suite as a whole: what is run, going on after an interruption, the report."""

import json
from pathlib import Path

import pytest

import fricmb as fm
from fricmb.bench import Options, Own, Setting, Store, fingerprint, measure_cell, names, report, report_body
from fricmb.bench._orders import measure_order
from fricmb.bench._plots import ahead
from fricmb.bench._scenes import SCENES
from fricmb.bench._suite import Cell, about, measure_named, plan, run, titles

ROOT = Path(__file__).parents[2]
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
    assert text.count("<svg") == 4
    assert "gave up &lt;here&gt;" in text
    assert "n^1.0" in text
    assert all(word not in text for word in ("<script", "src=", 'href="http', "@import", "url(http"))


def test_the_published_scheme_is_of_order_two():
    found = measure_order("bdf2-paper")
    assert found["order"] == pytest.approx(2.0, abs=0.05)


def test_cells_are_named_by_what_is_hard_in_them():
    cell = Cell("size", "chain", "auto", Setting(rtol=1e-4), 100)
    assert (cell.key, cell.row) == ("size/chain/auto/100", "size/chain/auto")


def test_a_page_of_its_own_refers_to_pictures_and_tables(monkeypatch):
    """The committed result: one picture before any table, and a page that loads at once.

    Its forty pictures are made, but not drawn: the pages' build does that.
    """
    monkeypatch.setattr("fricmb.bench._plots.svg", lambda figure: "<svg></svg>")
    result = json.loads((ROOT / "docs" / "benchmark" / "result.json").read_text(encoding="utf-8"))
    files = {}

    def put(name, content, words):
        assert name not in files, "each picture has a file of its own"
        files[name] = content
        return f"<a>{name}</a>"

    text = report_body(result, put=put)
    assert len(text) < 500_000
    assert text.index("ahead.svg") < text.index("<table")
    assert "nan" not in text
    assert all(files[f"{case}.html"].startswith("<table") for case in {cell["case"] for cell in result["cells"]})


def test_the_first_picture_shows_who_is_ahead():
    """A mark per scene and level where both reach it, right of 1 where fricmb is faster, open where it is alone."""
    own = {"seconds": 0.1, "metrics": {}}
    board = [
        {"case": "a", "level": 1e-2, "auto": own, "own": own, "peer": {"seconds": 0.5}},
        {"case": "a", "level": 1e-4, "auto": own, "own": own, "peer": None},
        {"case": "b", "level": 1e-2, "auto": None, "own": own, "peer": {"seconds": 0.05}},
        {"case": "b", "level": 1e-4, "auto": None, "own": None, "peer": {"seconds": 0.05}},
    ]
    (axes,) = ahead(board).axes
    marks = [sorted(line.get_xdata()) for line in axes.lines[:-1]]
    assert marks == [[0.5, 5.0], [], [], [1000.0]]
