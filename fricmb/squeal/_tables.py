"""Tables of a study, and files of them."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.squeal._derivatives import Derivatives
from fricmb.squeal._feed import Feed
from fricmb.squeal._growth import Growth
from fricmb.squeal._saturation import Saturation
from fricmb.squeal._screening import Screening
from fricmb.squeal._tracking import moving_most
from fricmb.squeal._uncertain import Uncertainty

if TYPE_CHECKING:
    from fricmb.squeal._study import Study

Table = tuple[tuple[str, ...], list[tuple[Any, ...]]]


def tables(study: Study) -> dict[str, Table]:
    """Names of columns, and rows, of each table."""
    found = {"map": _map(study), "modes": _modes(study), "contacts": _contacts(study), "thresholds": _thresholds(study)}
    numbers: dict[str, int] = {}
    for answer in study.answered:
        name, table = of_answer(answer, study)
        numbers[name] = numbers.get(name, 0) + 1
        found[name if numbers[name] == 1 else f"{name}_{numbers[name]}"] = table
    return found


def of_answer(answer: Any, study: Study) -> tuple[str, Table]:
    """The name and the table of one answer of a study."""
    if isinstance(answer, Feed):
        rows: list[tuple[Any, ...]] = [("part", name, "", share) for name, share in answer.parts.items()]
        rows += [("pair", p.moves[0], p.moves[1], p.share) for p in answer.pairs]
        rows.append(("velocities", "", "", answer.velocity))
        return "feed", (("kind", "name", "with", "share of growth"), rows)
    if isinstance(answer, Derivatives):
        return "derivatives", (("parameter", "value", "growth", "frequency", "apart", "threshold"), answer.rows())
    if isinstance(answer, Growth):
        rows = list(zip(answer.t.tolist(), answer.share.tolist(), strict=True))
        return "growth", (("t", "share"), rows)
    if isinstance(answer, Saturation):
        return "saturation", (("motion", "amplitude"), list(answer.amplitude.items()))
    if isinstance(answer, Uncertainty):
        columns = np.column_stack([answer.values, answer.growth, answer.frequency])
        return "uncertainty", ((*answer.names, "growth", "frequency"), [tuple(row) for row in columns.tolist()])
    if isinstance(answer, Screening):
        columns = np.column_stack([answer.effects, answer.errors, answer.scatter])
        rows = [(name, *row) for name, row in zip(answer.names, columns.tolist(), strict=True)]
        return "screening", (("parameter", "effect", "error", "scatter"), rows)
    _, name, values = answer
    rows = [(*here, values[i, j]) for i, j, here in _each(study)]
    return "amplitudes", ((*study.over, name), rows)


def _each(study: Study) -> list[tuple[int, int, tuple[float, ...]]]:
    """Numbers and values of each place."""
    n_a, n_b = study.shape
    first = study.values[0].tolist()
    second = study.values[1].tolist() if len(study.values) > 1 else None
    return [(i, j, (first[i],) if second is None else (first[i], second[j])) for i in range(n_a) for j in range(n_b)]


def _map(study: Study) -> Table:
    found = study.map
    rows = [
        (*here, float(found.growth[i, j]), float(found.frequency[i, j]), int(found.unstable[i, j]))
        for i, j, here in _each(study)
    ]
    return (*study.over, "largest growth rate", "angular frequency", "growing modes"), rows


def _modes(study: Study) -> Table:
    values, shapes, dofs = study.eigenvalues, study.shapes, study.dofs
    rows = [
        (*here, k, float(value.real), float(value.imag), moving_most(shapes[i, j, k], dofs))
        for i, j, here in _each(study)
        for k, value in enumerate(values[i, j])
        if np.isfinite(value)
    ]
    return (*study.over, "mode", "growth rate", "angular frequency", "moves most"), rows


def _contacts(study: Study) -> Table:
    names = study._contacts()
    found = {name: study.steady(name) for name in names}
    rows = [
        (*here, name, *(float(table[i, j]) for table in found[name].values()))
        for i, j, here in _each(study)
        for name in names
    ]
    return (*study.over, "contact", "normal force", "speed of slip", "friction"), rows


def _thresholds(study: Study) -> Table:
    rows = [
        (*(t.at[name] for name in study.over), t.kind, t.frequency, "above" if t.unstable_above else "below")
        for t in study.thresholds
    ]
    return (*study.over, "kind", "angular frequency", "unstable"), rows


def write_tables(study: Study, folder: Path) -> tuple[Path, ...]:
    """A CSV of each table."""
    written = []
    for name, (columns, rows) in tables(study).items():
        path = folder / f"{name}.csv"
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(rows)
        written.append(path)
    return tuple(written)
