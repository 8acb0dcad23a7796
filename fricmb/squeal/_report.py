"""A page about a study that asks no network for anything."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricmb.plot._html import block, picture
from fricmb.squeal import _pictures
from fricmb.squeal._derivatives import Derivatives
from fricmb.squeal._feed import Feed
from fricmb.squeal._growth import Growth
from fricmb.squeal._saturation import Saturation
from fricmb.squeal._screening import Screening
from fricmb.squeal._tables import of_answer, tables
from fricmb.squeal._uncertain import Uncertainty

if TYPE_CHECKING:
    from fricmb.squeal._study import Study

#: Rows of a table that are shown; all of them stand in its CSV.
_MOST = 200
_HEAD = (
    '<!doctype html><html lang="en"><head><meta charset="utf-8">'
    '<meta name="viewport" content="width=device-width"><title>{}</title></head><body>'
)
_TITLES = {
    Feed: "What feeds the mode",
    Derivatives: "Which parameters calm it",
    Growth: "Growth in a run",
    Saturation: "Where growth ends",
    Uncertainty: "How sure that is",
    Screening: "Which parameters matter",
}


def write_report(study: Study, path: Path) -> Path:
    """Write the page; returns its path."""
    title = f"Squeal of {study.scene.name}"
    parts = [
        f"<h1>{escape(title)}</h1>",
        f"<pre>{escape(str(study))}</pre>",
        picture(lambda: _pictures.overview(study)),
    ]
    if len(study.over) > 1:
        parts.append(picture(lambda: _pictures.modes(study)))
    for answer in study.answered:
        parts += _answer(answer, study)
    own = {"map", "modes", "contacts", "thresholds"}
    parts += [_folded(name, *table) for name, table in tables(study).items() if name in own]
    path.write_text(_HEAD.format(escape(title)) + block(*parts) + "</body></html>\n", encoding="utf-8")
    return path


def _answer(answer: Any, study: Study) -> list[str]:
    """One answer: in words, as a picture, as a table."""
    name, (columns, rows) = of_answer(answer, study)
    if isinstance(answer, tuple):
        return [f"<h2>Amplitude of {escape(answer[1])}</h2>", _folded(name, columns, rows)]
    at = ", ".join(f"{key} = {value:g}" for key, value in answer.at.items())
    parts = [f"<h2>{_TITLES[type(answer)]}</h2>", f"<p>{escape(at)}</p>", f"<pre>{escape(str(answer))}</pre>"]
    if isinstance(answer, Feed):
        parts.append(picture(lambda: _pictures.shares(answer)))
    elif isinstance(answer, Growth):
        parts.append(picture(lambda: _pictures.rates(answer)))
    elif isinstance(answer, Uncertainty):
        parts.append(picture(lambda: _pictures.spread(answer)))
    return [*parts, _folded(name, columns, rows)]


def _folded(name: str, columns: tuple[str, ...], rows: list[tuple[Any, ...]]) -> str:
    head = "".join(f"<th>{escape(column)}</th>" for column in columns)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(_short(cell))}</td>" for cell in row) + "</tr>" for row in rows[:_MOST]
    )
    more = f"<p>{len(rows) - _MOST} more rows in the CSV.</p>" if len(rows) > _MOST else ""
    table = f"<table><tr>{head}</tr>{body}</table>"
    return f"<details><summary>{escape(name)}: {len(rows)} rows</summary>{table}{more}</details>"


def _short(cell: Any) -> str:
    return f"{cell:.8g}" if isinstance(cell, float) else str(cell)
