"""The README and the pages of the documentation: their code and commands run, and people can read them."""

import ast
import inspect
import os
import re
import shlex
import sys
import types
from pathlib import Path

import pytest

import fricmb as fm
from fricmb.cli import main

ROOT = Path(__file__).parents[1]
# What is fenced as python, and the cells of pages that are notebooks (without their options).
BLOCK = re.compile(
    r"^```(?:python|\{code-cell\} python)\n(?:---\n.*?^---\n|(?::[^\n]*\n)*)(.*?)^```", re.MULTILINE | re.DOTALL
)
COMMAND = re.compile(r"^    (fricmb .*)$", re.MULTILINE)
FENCE = re.compile(r"^(`{3,}|:{3,}).*?^\1$", re.MULTILINE | re.DOTALL)
# Pages that sphinx makes are looked at where they are made; changes and decisions grow by the line.
PAGES = sorted(
    page
    for page in (ROOT / "docs").rglob("*.md")
    if not page.name.startswith("_") and not {"gallery", "generated", "_build"} & set(page.parts)
)
EVERYTHING = (ROOT / "README.md", *PAGES)
CODED = [page for page in EVERYTHING if BLOCK.search(page.read_text(encoding="utf-8"))]
#: More than that takes a reader over ten minutes.
WORDS = 2000
#: Commands that need a package from elsewhere (tests/test_template.py runs them), or are no command but its form.
ELSEWHERE = ("fricmb law Valley", "fricmb COMMAND")


def name(path):
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("page", CODED, ids=name)
def test_code_on_the_page_runs(page, tmp_path, monkeypatch):
    """In a folder beside the data that pages read, as in the documentation."""
    (tmp_path / "data").symlink_to(ROOT / "docs" / "data")
    (tmp_path / "pages").mkdir()
    monkeypatch.chdir(tmp_path / "pages")
    monkeypatch.setitem(os.environ, "MPLBACKEND", "Agg")
    file = tmp_path / f"{page.stem}.py"
    file.write_text("\n".join(BLOCK.findall(page.read_text(encoding="utf-8"))))
    # a module that can be imported, as the one that readers paste it into: its classes can be pickled
    module = types.ModuleType("page")
    monkeypatch.setitem(sys.modules, "page", module)
    exec(compile(file.read_text(), str(file), "exec"), module.__dict__)


def commands():
    for page in PAGES:
        for command in COMMAND.findall(page.read_text(encoding="utf-8")):
            if not command.startswith(ELSEWHERE):
                yield pytest.param(page, command, id=f"{name(page)}: {command}")


@pytest.mark.slow
@pytest.mark.parametrize(("page", "command"), list(commands()))
def test_command_on_the_page_runs(page, command, tmp_path, monkeypatch, capsys):
    """As typed; a Python file that it names is what the page says up to there."""
    monkeypatch.chdir(tmp_path)
    arguments = shlex.split(command)[1:]
    for file in (word for word in arguments if word.endswith(".py")):
        text = page.read_text(encoding="utf-8").partition(command)[0]
        (tmp_path / file).write_text("\n".join(BLOCK.findall(text)))
    assert main(arguments) == 0, capsys.readouterr().err


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_page_is_read_in_ten_minutes(page):
    words = [word for word in FENCE.sub("", page.read_text(encoding="utf-8")).split() if word.strip("|-")]
    assert len(words) <= WORDS


def test_decisions_are_short_and_name_ones_that_stand():
    pages = sorted((ROOT / "docs" / "decisions").glob("0*.md"))
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert len(text.split()) <= 450, page.name
        named = re.findall(r"<(?:/decisions/)?(\d{4}-[a-z-]+)>|\{doc\}`(\d{4}-[a-z-]+)`", text)
        assert {a or b for a, b in named} <= {other.stem for other in pages}, page.name


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_pictures_say_what_they_show(page):
    text = page.read_text(encoding="utf-8")
    for alt, target in re.findall(r"!\[([^\]]*)\]\(([^)]*)\)", text):
        assert len(alt.split()) >= 3, f"{target} has no text that stands for it"
    for directive in re.findall(r"^```\{(?:image|figure)\}(.*?)^```", text, re.MULTILINE | re.DOTALL):
        assert ":alt:" in directive
    for cell in re.findall(r"^```\{code-cell\} python\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        if re.search(r"plot\.|subplots", cell):
            assert re.search(r"^    alt: ", cell, re.MULTILINE), cell


def test_readme_has_exactly_two_set_up_commands():
    fenced = re.findall(r"^```\n(.*?)\n```$", (ROOT / "README.md").read_text().partition("## A scene")[0], re.MULTILINE)
    assert fenced == ["pip install . && fricmb run brake4dof", 'pip install ".[test]" && pytest']


def test_page_of_models_knows_the_unit_of_each_argument():
    """Where it does not, the pages are not built."""
    tables = {
        held.targets[0].id: ast.literal_eval(held.value)
        for held in ast.parse((ROOT / "docs" / "_pages.py").read_text(encoding="utf-8")).body
        if isinstance(held, ast.Assign) and held.targets[0].id in ("DIMENSIONS", "NUMBERS")
    }
    known = {*tables["DIMENSIONS"], *tables["NUMBERS"]}
    builds = [model.build for model in fm.models.catalogue.values()]
    assert {argument for build in builds for argument in inspect.signature(build).parameters} - known == set()


def test_reference_names_all_that_is_public():
    """But for constants, and what stands on the page of errors or is told in words (integrators, compiled_force)."""
    import fricmb as fm

    pages = [ROOT / "docs" / "reference" / f"{page}.md" for page in ("api", "laws", "models")]
    text = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    listed = set(re.findall(r"^   ([\w.]+)$", text, re.MULTILINE))
    missing = []
    for package in ("", "analysis.", "testing.", "plot.", "normal.", "laws.", "space.", "fe.", "measure."):
        held = getattr(fm, package[:-1]) if package else fm
        for public in held.__all__:
            thing = getattr(held, public)
            if isinstance(thing, type | types.FunctionType) and package + public not in listed:
                missing.append(package + public)
    errors = {"FricmbError", "IntegrationError", "Interrupted", "LawError", "SceneError", "analysis.AnalysisError"}
    words = {"testing.ConformanceError", "analysis.compiled_force", "plot.finish", "laws.FrictionLaw", "laws.symbolic"}
    words |= {"plot.Units"}  # stands there as Units
    assert sorted(set(missing) - errors - words - {"laws.RegularisedLaw", "laws.Law"}) == []
