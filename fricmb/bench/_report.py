"""The report: one HTML file that needs no network."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from fricmb.bench import _plots as plots
from fricmb.bench._size import fits
from fricmb.bench._tables import LEVELS, scoreboard, tolerance_statistic

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; max-width: 68rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 13px; }
td, th { border-bottom: 1px solid #ddd; padding: .2rem .6rem; text-align: right; vertical-align: top; }
td:first-child, th:first-child, td.text { text-align: left; }
svg { max-width: 100%; height: auto; } .bad { color: #b00; } .good { color: #080; } .note { color: #666; }
details { margin: .5rem 0; } summary { cursor: pointer; }
"""


def table(head: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """An HTML table; strings are escaped, a pair (text, class) sets the class of its cell."""
    lines = ["<table><tr>", *(f"<th>{html.escape(name)}</th>" for name in head), "</tr>"]
    for row in rows:
        lines.append("<tr>")
        for value in row:
            text, kind = value if isinstance(value, tuple) else (value, "")
            lines.append(f'<td class="{kind}">{html.escape(shown(text))}</td>')
        lines.append("</tr>")
    return "".join(lines) + "</table>\n"


def shown(value: Any) -> str:
    """A value in few characters."""
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.2g}"
    return str(value)


def page(title: str, parts: Iterable[str]) -> str:
    """A whole HTML page."""
    head = f"<!doctype html><html lang='en'><meta charset='utf-8'><title>{html.escape(title)}</title>"
    return f"{head}<style>{_STYLE}</style><h1>{html.escape(title)}</h1>\n" + "\n".join(parts) + "</html>\n"


#: Takes the name of a file, its content, and what it shows; gives the HTML that stands for it on the page.
Put = Callable[[str, str, str], str]


def report(result: dict[str, Any]) -> str:
    """The report of a result of :func:`fricmb.bench.run`."""
    return page("fricmb: error against run time", _parts(result, _inside))


def report_body(result: dict[str, Any], *, put: Put | None = None) -> str:
    """The same without the frame of a page, for another one.

    Parameters
    ----------
    result : dict
        What :func:`fricmb.bench.run` gives, or ``result.json`` holds.
    put : callable, optional
        ``put(name, content, words)`` keeps a picture (``name`` ends in ".svg") or a table of all runs (".html") as a
        file of its own and gives the HTML that refers to it; default: all of it stands in the text.
    """
    return "\n".join(_parts(result, put or _inside))


def _inside(name: str, content: str, words: str) -> str:
    return content if name.endswith(".svg") else f"<details><summary>{html.escape(words)}</summary>{content}</details>"


def _parts(result: dict[str, Any], put: Put) -> Iterator[str]:
    """What one reads first, then all else, folded."""
    yield _summary(_board(result))
    yield put("ahead.svg", plots.svg(plots.ahead(_board(result))), "time of the best peer over that of auto, by scene")
    yield _AHEAD + "<h2>Time to reach an error</h2>" + short_table(result)
    yield "<h2>Details</h2>"
    yield fold("All errors, with the fastest program for each", scoreboard_table(result))
    yield fold("How errors and times are measured, on which machine", _measured(result["about"]))
    yield fold("How far the error is the tolerance", _tolerance(result))
    yield fold("Error against time, scene by scene", "".join(_cases(result, put)))
    yield fold("Orders of convergence", _ORDERS + "".join(_formulas(result, put)))
    yield fold("Cost against size", "".join(_sizes(result, put)))
    not_run = ((row["case"], row["method"], (row["why"], "text")) for row in result["refusals"])
    yield fold("Not run", table(("scene", "method", "why"), not_run))


def fold(title: str, content: str) -> str:
    """Content below a title that opens it."""
    return f"<details><summary>{html.escape(title)}</summary>{content}</details>"


def _summary(board: list[dict[str, Any]]) -> str:
    """In how many scenes fricmb is ahead, for each error."""
    lines = []
    for level in LEVELS:
        entries = [entry for entry in board if entry["level"] == level]
        reached = [(entry["auto"] or entry["own"], entry["peer"]) for entry in entries if entry["auto"] or entry["own"]]
        both = [(mine, peer) for mine, peer in reached if peer is not None]
        ahead = sum(mine["seconds"] <= peer["seconds"] for mine, peer in both)
        alone = len(reached) - len(both)
        lines.append(
            f"<li>an error of {level:g}: fricmb is faster than every other program in {ahead} of {len(both)} scenes;"
            f" in {alone} more no other program reaches this error</li>"
        )
    return "<ul>" + "".join(lines) + "</ul>"


def short_table(result: dict[str, Any]) -> str:
    """Milliseconds to a loose and a tight error, and who else comes nearest."""
    rows = []
    board = _board(result)
    for case in dict.fromkeys(entry["case"] for entry in board):
        row: list[Any] = [(result["titles"].get(case, case).partition(" (")[0], "text")]
        for entry in (entry for entry in board if entry["case"] == case and entry["level"] in (1e-2, 1e-6)):
            mine, peer = entry["auto"] or entry["own"], entry["peer"]
            first = mine is not None and (peer is None or mine["seconds"] <= peer["seconds"])
            row += [(_ms(mine), "good" if first else ""), _ms(peer), (peer["method"] if peer else "", "text")]
        rows.append(row)
    head = ("scene", "error 1e-2: fricmb", "best other", "which", "error 1e-6: fricmb", "best other", "which")
    return table(head, rows) + "<p class='note'>Milliseconds of processor time; - : no setting reached this error.</p>"


def _measured(about: dict[str, Any]) -> str:
    versions = ", ".join(f"{name} {number}" for name, number in about["versions"].items())
    machine = f"{html.escape(about['date'])}, {html.escape(about['machine'])}; {html.escape(versions)}."
    return f"{_NOTES}<p>{machine}</p>"


def _cases(result: dict[str, Any], put: Put) -> Iterator[str]:
    """Each scene: its picture, and its runs."""
    cells = [*result["cells"], *result["daes"]]
    for case in dict.fromkeys(cell["case"] for cell in cells):
        rows = [cell for cell in cells if cell["case"] == case]
        title = result["titles"].get(case, case)
        yield f"<h3>{html.escape(title)}</h3>"
        if any(row["metrics"] for row in rows):
            yield put(f"{case}.svg", plots.svg(plots.work_precision(rows)), f"error against processor time: {title}")
        yield put(f"{case}.html", _runs(rows), "all runs")


def _formulas(result: dict[str, Any], put: Put) -> Iterator[str]:
    """A picture for each family of formulas."""
    formulas = [row for row in result["orders"] if "steps" in row]
    for family in dict.fromkeys(row["method"].partition(",")[0] for row in formulas):
        rows = [row for row in formulas if row["method"].partition(",")[0] == family]
        picture = plots.svg(plots.convergence(rows, family))
        yield put(f"order_{family}.svg", picture, f"error against steps, {family}: {_SLOPES}")


_AHEAD = """<p class="note">For each scene: processor time of the fastest other program over that of <code>auto</code>,
for errors of 1e-2 to 1e-8 that both reach. Right of the line fricmb is ahead; an open mark at the edge: no other
program reaches this error.</p>"""

_NOTES = """<p>The state error is the largest error of a position or velocity over the grid of the reference, each
signal over its largest value. References are event-driven solutions in 30-digit arithmetic, closed forms, or published
digits. Other programs run the same scene with friction smoothed over a slip speed eps (times the largest speed), with
a compiled right-hand side and the analytic Jacobian; eps goes from 1e-2 to 1e-7, the tolerance is a hundredth of eps.
Their transitions are where the slip speed crosses 10 eps. Times are processor times, the least of several runs in one
process, without compilation.</p>"""


_SLOPES = (
    "each line is one formula with fixed steps; the error of order p falls by p decades while the number of steps "
    "rises by one, down to round-off; the legend has the fitted slope"
)
_ORDERS = """<p>The largest error over a run without stick against the number of steps. It includes times between
steps, where the order is that of the dense output (for Radau IIA about s, not the 2 s - 1 at the ends of steps). bdf
leaves the run to Radau IIA at tight tolerances, with fewer steps; orders are fitted up to there.</p>"""


def _board(result: dict[str, Any]) -> list[dict[str, Any]]:
    return scoreboard([*result["cells"], *result["daes"]])


def scoreboard_table(result: dict[str, Any]) -> str:
    """Milliseconds to each level: auto, best of fricmb, best peer."""
    board = _board(result)
    head = ["scene", *(f"{who}, {level:g}" for level in LEVELS for who in ("auto", "best peer"))]
    rows = []
    for case in dict.fromkeys(entry["case"] for entry in board):
        row: list[Any] = [case]
        for entry in (entry for entry in board if entry["case"] == case):
            auto, peer = entry["auto"] or entry["own"], entry["peer"]
            first = auto is not None and (peer is None or auto["seconds"] <= peer["seconds"])
            row.append((_ms(auto), "good" if first else ""))
            row.append(_ms(peer) + (f" {peer['method']}" if peer else ""))
        rows.append(row)
    return table(head, rows) + "<p class='note'>milliseconds; - : not reached by any setting that was tried.</p>"


def _ms(cell: dict[str, Any] | None) -> str:
    return "-" if cell is None else f"{1e3 * cell['seconds']:.3g}"


def _tolerance(result: dict[str, Any]) -> str:
    found = tolerance_statistic(result["cells"])
    if not found["runs"]:
        return "<p>no runs</p>"
    text = (
        "<p>The error of auto, over rtol times the growth of errors in the scene, is from 0.01 to 100 in "
        f"{100 * found['within']:.0f} % of {found['runs']} runs, and not above 100 in {100 * found['not_above']:.0f} %."
        f" With the runs that are more accurate at no cost it is {100 * found['fair']:.0f} %: they take as many steps"
        " as at the loosest tolerance, because transitions, the fastest mode or the length of the run limit their"
        " steps. The runs outside:</p>"
    )
    rows = ((x["case"], x["rtol"], x["used"], x["ratio"], (x["why"], "text")) for x in found["exceptions"])
    return text + table(("scene", "rtol", "integrator", "ratio", "what"), rows)


_COLUMNS = ("state", "time", "missed", "false", "force", "creep", "energy")


def _runs(rows: Iterable[dict[str, Any]]) -> str:
    costs = ("steps", "evaluations", "factorizations", "failure")
    head = ("method", "setting", "ms", "compile s", "MB", *_COLUMNS, *costs)
    return table(head, (_run(row) for row in rows))


def _run(row: dict[str, Any]) -> list[Any]:
    metrics = row["metrics"] or {}
    setting = ", ".join(f"{key} {value:g}" for key, value in row["setting"].items() if value is not None)
    used = f" ({row['used']})" if row["used"] not in ("", row["method"]) else ""
    counters = row["counters"]
    return [
        row["method"] + used,
        setting,
        None if row["seconds"] is None else 1e3 * row["seconds"],
        row["first"],
        row["memory"],
        *((metrics.get(key), "bad" if key in ("missed", "false") and metrics.get(key) else "") for key in _COLUMNS),
        counters.get("n_steps"),
        counters.get("n_rhs"),
        counters.get("n_lu"),
        (row["failure"], "text bad"),
    ]


def _sizes(result: dict[str, Any], put: Put) -> Iterator[str]:
    powers = fits(result["sizes"])
    for case in dict.fromkeys(row["case"] for row in result["sizes"]):
        rows = [row for row in result["sizes"] if row["case"] == case]
        title = result["titles"].get(case, case)
        yield put(f"size_{case}.svg", plots.svg(plots.cost_against_size(rows, powers, case, title)), f"cost: {title}")
        head = ("method", "n", "run s", "building the scene s", "transitions", "error", "failure")
        keys = ("method", "n", "seconds", "build", "events", "error", "failure")
        yield put(f"size_{case}.html", table(head, ([row.get(key) for key in keys] for row in rows)), "all runs")
