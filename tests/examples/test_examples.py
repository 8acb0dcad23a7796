"""The examples of the gallery: each small one asks, draws once, and asserts a number of its own; all of these run."""

import ast
import re
import sys
import types
from pathlib import Path

import matplotlib
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
#: Longer studies; the documentation runs them.
LONG = ("methods", "paper")
SMALL = sorted(file for file in EXAMPLES.rglob("plot_*.py") if file.parent.name not in LONG)


def name(file):
    return f"{file.parent.name}/{file.stem}"


def test_there_are_thirty_and_they_are_in_groups():
    assert len(SMALL) >= 30
    folders = {file.parent for file in EXAMPLES.rglob("plot_*.py")}
    assert EXAMPLES not in folders
    assert all((folder / "README.txt").exists() for folder in folders)


@pytest.mark.parametrize("file", SMALL, ids=name)
def test_it_has_the_form(file):
    text = file.read_text(encoding="utf-8")
    title, rule, *rest = ast.get_docstring(ast.parse(text)).splitlines()
    assert len(text.splitlines()) - len(rest) < 37  # without the prose
    assert title.endswith("?")
    assert set(rule) == {"="}
    assert len(rule) >= len(title)
    words = " ".join(rest)
    assert ":math:" in words or re.search(r"\d", words), "no number, formula or source in its text"
    checks = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Assert)]
    assert checks


@pytest.mark.slow
@pytest.mark.parametrize("file", SMALL, ids=name)
def test_it_runs_and_draws_one_picture(file, monkeypatch):
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.close("all")
    monkeypatch.setattr(plt, "show", lambda *args, **kwargs: None)
    module = types.ModuleType("example")  # what it declares can be pickled
    monkeypatch.setitem(sys.modules, "example", module)
    exec(compile(file.read_text(encoding="utf-8"), str(file), "exec"), module.__dict__)
    assert len(plt.get_fignums()) == 1
    plt.close("all")
