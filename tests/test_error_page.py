"""Every message that fricmb raises on purpose stands on a page of errors, and these hold no other."""

import ast
import functools
import inspect
import re
import textwrap
from pathlib import Path

import pytest

import fricmb as fm
from fricmb import _calls, errors
from fricmb._simulate._blame import _formula_without_value, _law_without_value, blame
from fricmb._simulate._result import not_there
from fricmb.analysis import AnalysisError
from fricmb.integrate.collocation import integrator as _collocation
from fricmb.integrate.run import memory, stop
from fricmb.integrate.taylor import integrator as _taylor

BLAME = (blame, _formula_without_value, _law_without_value, fm.space.OnPlane.undefined)
ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "docs" / "reference" / name for name in ("errors.md", "errors_results.md", "errors_fe.md")]
PAGE = "\n".join(path.read_text(encoding="utf-8") for path in PAGES)
#: What is raised with a message of its own.
RAISED = {
    "SceneError", "LawError", "AnalysisError", "ArgumentError", "FricmbError", "IntegrationError", "no_start", "error",
}  # fmt: skip


def text_of(node):
    """The message with ... for what is put in; None if it is put together elsewhere."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        parts = (part.value if isinstance(part, ast.Constant) else "..." for part in node.values)
        return "".join(map(str, parts))
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return (text_of(node.left) or "...") + (text_of(node.right) or "...")
    return None


def raised(path):
    """Messages of the raise statements of a file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not (isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call)):
            continue
        name = getattr(node.exc.func, "id", getattr(node.exc.func, "attr", ""))
        if name in RAISED:
            texts = map(text_of, node.exc.args)
            yield from (text for text in texts if text and re.search(r"[a-z]{2}", text.replace("...", "")))


def reasons():
    """Why a run stopped: the tables of the integrators, and what the mechanisms' returns."""
    from fricmb.integrate.implicit.impacts.impact import Impacts
    from fricmb.integrate.implicit.output import failure_text
    from fricmb.integrate.run.outcomes import FAILURES

    for table in (FAILURES, _collocation._FAILURES, _taylor.FAILURES):
        yield from (re.sub(r"\{.*?\}", "...", text) for text in table.values())
    mechanisms = failure_text.failure_text, failure_text._none_found
    impacts = Impacts._piles_up, Impacts._apply, Impacts._is_sound
    calls = _calls._said, _calls._unknown, _calls._unnamed
    memories = memory.Footprint.excess, memory.no_room, memory.refused
    for function in (*calls, *mechanisms, *impacts, *memories, stop.Watch.look, not_there, *BLAME):
        for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(function)))):
            text = text_of(node.value) if isinstance(node, ast.Return | ast.Assign) else None
            if text and text.strip("."):
                yield text


@functools.cache
def messages():
    files = sorted([*(ROOT / "fricmb").rglob("*.py"), *(ROOT / "models").rglob("*.py")])
    return sorted({text for path in files for text in raised(path)} | set(reasons()))


def entries():
    """The first column of the tables, but for that of the classes."""
    return re.findall(r"^\| `([^`]+)` \|", PAGE.partition("## Names and values")[2], re.MULTILINE)


def matches(entry, message):
    """Whether all words of an entry stand in a message, in order, ... being anything."""
    return re.search(".*".join(map(re.escape, entry.split("..."))), message, re.DOTALL) is not None


def test_every_message_has_an_entry():
    missing = [text for text in messages() if not any(matches(entry, text) for entry in entries())]
    assert not missing, "\n".join(missing)


@pytest.mark.parametrize("entry", entries())
def test_every_entry_is_a_message(entry):
    # those of _refuse, unknown_name and no_start
    spoken = ["...: ... must be ..., got ...", "unknown ...; did you mean ...?", "No consistent initial values"]
    assert any(matches(entry, text) for text in [*messages(), *spoken])


def test_every_class_is_on_the_page():
    classes = [held for held in vars(errors).values() if isinstance(held, type) and issubclass(held, Exception)]
    for held in [*classes, AnalysisError, fm.testing.ConformanceError]:
        assert held.__name__ in PAGE
