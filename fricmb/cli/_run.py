"""``fricmb run``."""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import fricmb as fm
from fricmb._simulate._progress import named_bar
from fricmb.cli._files import pieces, sizes, write_all
from fricmb.cli._load import Loaded, load
from fricmb.cli._output import finite, make_folder, print_aside, stdout_to_stderr
from fricmb.cli._summary import as_json, as_text
from fricmb.errors import IntegrationError, Interrupted, SceneError
from fricmb.integrate.compile.cache_files import say

if TYPE_CHECKING:
    from fricmb.audit import Audit

#: How much longer than the time limit the files of a run may take: a share of it, and at least so many seconds.
LONGER, LEAST = 0.1, 5.0
#: Bytes from which on it is asked whether a run is to be written.
LARGE = 1e9


def run(options: argparse.Namespace) -> int:
    """Simulate, write, tell; 3 with a partial result if the integration fails, 130 after Ctrl-C.

    With ``--json`` whatever else is printed, by a model say, goes to stderr.
    """
    with stdout_to_stderr(options.json):
        return _run(options)


def _run(options: argparse.Namespace) -> int:
    loaded = load(options.model, case=options.case, values=options.values)
    t_end = _t_end(options, loaded)
    folder = options.out or Path("fricmb-out") / loaded.label
    make_folder(folder)
    shown = sys.stderr.isatty() and not (options.json or options.quiet)
    until = math.inf if options.time_limit is None else time.monotonic() + options.time_limit
    failure: IntegrationError | Interrupted | None = None
    try:
        sol = fm.simulate(
            loaded.scene,
            t_end=t_end,
            rtol=options.rtol,
            method=options.method,
            step=options.step,
            time_limit=options.time_limit,
            t_eval=_grid(options.points, t_end),
            progress=shown,
        )
    except (IntegrationError, Interrupted) as error:
        if error.partial is None:
            raise
        sol, failure = error.partial, error
    found = _results(sol, failure, folder, options, shown, until + max(LONGER * (options.time_limit or 0.0), LEAST))
    if options.json:
        print_aside(found.text)
    elif not options.quiet:
        print(as_text(sol))
    if found.audit is not None and not options.json:
        print(found.audit)
    if not (options.json or options.quiet):
        print(f"written      {folder}{'/' if folder.name else ''}: {', '.join(found.written)}")
    if failure is not None:
        print(f"fricmb: {' '.join(str(failure).split())}; what was computed until then is in {folder}", file=sys.stderr)
        return 130 if isinstance(failure, Interrupted) else 3
    return 0


class _Results(NamedTuple):
    """The summary as JSON, the audit that was asked for, and the names of the files."""

    text: str
    audit: Audit | None
    written: list[str]


def _results(
    sol: fm.Solution,
    failure: IntegrationError | Interrupted | None,
    folder: Path,
    options: argparse.Namespace,
    shown: bool,
    until: float,
) -> _Results:
    """Energies, audit and files, with a bar of their own: of a long run they may take longer than it did."""
    without = _unwanted(sol, folder, options)
    plots = None if options.no_plots else options.format
    before = 2 if options.audit else 1
    with named_bar(before + pieces(sol, plots), "results", shown) as told:
        told(0, "energies")
        summary, audit = as_json(sol, failure), None
        if options.audit:
            told(1, "audit")
            audit = sol.audit()
            summary["audit"] = {"ok": audit.ok, "rtol": audit.rtol, "checks": [_row(check) for check in audit.checks]}
        text = json.dumps(finite(summary), indent=2, allow_nan=False) + "\n"
        written = write_all(
            sol, folder, text, plots=plots, told=lambda done, name: told(before + done, name), until=until,
            without=without,
        )  # fmt: skip
    if len(written) + len(without) < pieces(sol, plots):
        say("the time limit was reached: tables and pictures that are missing were not written in time")
    return _Results(text, audit, written)


def _unwanted(sol: fm.Solution, folder: Path, options: argparse.Namespace) -> tuple[str, ...]:
    """Files of gigabytes that nobody wants: asked on a terminal; elsewhere the table alone is left out."""
    wanted = sizes(sol)
    if options.yes or sum(wanted.values()) < LARGE:
        return ()
    told = ", ".join(f"{name} of about {size / 1e9:.2g} GB" for name, size in wanted.items())
    if not options.json and sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty():
        print(f"fricmb: {sol.t.size} steps would be written to {folder}: {told}. Write them? [y/N] ", end="",
              file=sys.stderr, flush=True)  # fmt: skip
        return () if sys.stdin.readline().strip().lower() in ("y", "yes") else tuple(wanted)
    say(f"left out: {told.rpartition(', ')[2]}; --yes writes it, --points makes it small")
    return ("solution.csv",)


def _row(check: Any) -> dict[str, Any]:
    """A check as data: sizes that are no numbers, and times that are none, as null."""
    found = {**asdict(check), "ok": check.ok}
    return {name: None if isinstance(v, float) and not math.isfinite(v) else v for name, v in found.items()}


def _t_end(options: argparse.Namespace, loaded: Loaded) -> float:
    t_end = options.t_end if options.t_end is not None else loaded.t_end
    if t_end is None:
        raise SceneError(f"--t-end is missing: {options.model} does not define t_end")
    if isinstance(t_end, bool) or not isinstance(t_end, (int, float)) or not (math.isfinite(t_end) and t_end > 0):
        raise SceneError(f"--t-end: expected a positive number; got {t_end!r}")
    return float(t_end)


def _grid(points: int | None, t_end: float) -> np.ndarray | None:
    if points is None:
        return None
    if points < 2:
        raise SceneError(f"--points: expected at least 2; got {points}")
    return np.linspace(0.0, t_end, points)
