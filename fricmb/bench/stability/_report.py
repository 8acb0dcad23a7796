"""The stability report: one HTML file that needs no network."""

from __future__ import annotations

import html
from collections.abc import Iterator
from typing import Any

from fricmb.bench._plots import svg
from fricmb.bench._report import page, table
from fricmb.bench.stability import _plots as plots
from fricmb.bench.stability._axis import FAST, SMALL
from fricmb.bench.stability._grid import VERDICTS
from fricmb.bench.stability._regions import axis_table

_GOOD = {"correct": "good", "wrong": "bad", "crashed": "bad"}


def stability_report(result: dict[str, Any]) -> str:
    """The report of a result of :func:`run_stability`, with an "about" of the suite beside it."""
    return page("fricmb: stability, stiff and extreme scenes", _parts(result))


def stability_body(result: dict[str, Any]) -> str:
    """The same without the frame of a page, for another one."""
    return "\n".join(_parts(result))


def _parts(result: dict[str, Any]) -> Iterator[str]:
    about = result["about"]
    yield f"<p>{html.escape(about['date'])}, {html.escape(about['machine'])}; fricmb {about['versions']['fricmb']}.</p>"
    yield "<h2>Regions</h2><p class='note'>From the coefficients in the code.</p>" + svg(plots.regions())
    yield svg(plots.axis())
    rows = axis_table()
    yield table(list(rows[0]), ([*row.values()] for row in rows))
    yield "<h2>Vibration that steps do not resolve</h2>" + _axis(result["axis"])
    yield "<h2>Stiff and extreme scenes</h2>" + grid_table(result["grid"])
    yield "<details><summary>errors and reasons</summary>" + _reasons(result["grid"]) + "</details>"


def _axis(rows: list[dict[str, Any]]) -> str:
    text = (
        f"<p class='note'>Undamped modes that start at {SMALL:g} of a slow one (frequency 1), run for 200 at rtol and "
        "atol 1e-5: amplitude at the end. It should be near what it was, or damped away; more is growth.</p>"
    )
    head = ("integrator", "contact", "steps", *(f"ω = {w:g}" for w in FAST), "energy residual", "failure")
    return text + table(
        head,
        (
            [row["method"], row["state"], row.get("steps"), *_amplitudes(row), row.get("energy"), row.get("failure")]
            for row in rows
        ),
    )


def _amplitudes(row: dict[str, Any]) -> list[Any]:
    # keys are floats in a fresh result and text in one that was read from JSON
    held = {float(w): amplitude for w, amplitude in row.get("amplitude", {}).items()}
    return [held.get(w) for w in FAST]


def grid_table(rows: list[dict[str, Any]]) -> str:
    """Scenes down, integrators across."""
    methods = list(dict.fromkeys(row["method"] for row in rows))
    found = {(row["group"], row["value"], row["method"]): row for row in rows}
    lines = []
    for group, value in dict.fromkeys((row["group"], row["value"]) for row in rows):
        verdicts = [found.get((group, value, method), {}).get("verdict", "-") for method in methods]
        lines.append([f"{group}: {value}", *((verdict, _GOOD.get(verdict, "note")) for verdict in verdicts)])
    counts = [
        [verdict, *(sum(row["verdict"] == verdict and row["method"] == method for row in rows) for method in methods)]
        for verdict in VERDICTS
    ]
    return table(("verdict", *methods), counts) + table(("scene", *methods), lines)


def _reasons(rows: list[dict[str, Any]]) -> str:
    head = ("scene", "integrator", "verdict", "error", "seconds", "steps", "why")
    return table(
        head,
        (
            [f"{row['group']}: {row['value']}", row["method"], row["verdict"], row.get("error"), row.get("seconds"),
             row.get("steps"), (row["why"], "text")]
            for row in rows
        ),
    )  # fmt: skip
