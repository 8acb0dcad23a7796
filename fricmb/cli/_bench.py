"""``fricmb bench``."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fricmb._simulate._progress import bar_options
from fricmb.bench import (
    Options,
    Store,
    about,
    fingerprint,
    law_costs,
    names,
    report,
    run,
    scoreboard,
    start_up_times,
    tolerance_statistic,
)
from fricmb.cli._output import make_folder
from fricmb.errors import unknown_name


def bench(options: argparse.Namespace) -> int:
    """Measure, with a bar; write the report and the numbers."""
    if options.what == "stability":
        return _stability(options)
    known = names()
    for name in options.scene:
        if name not in known:
            raise unknown_name("--scene", name, known)
    begin = time.perf_counter()
    chosen = Options(quick=options.quick, scenes=tuple(options.scene), limit=options.limit)
    store = Store(options.out / "cells.jsonl", fingerprint(chosen))
    if options.again:
        store.clear()
    with _bar() as progress:
        result = run(chosen, store, progress)
    if not options.quick and not options.scene:
        result["start_up"] = start_up_times()
        result["own_laws"] = law_costs()
    _write(options.out, "report.html", report(result))
    _write(options.out, "result.json", json.dumps(result, indent=1))
    if options.json:
        print(json.dumps(result))
    else:
        _summary(result, options.out)
        print(f"took {time.perf_counter() - begin:.0f} s")
    return 0


def _stability(options: argparse.Namespace) -> int:
    """The grid of extreme scenes and the regions; exit status 3 where something was wrong without a word."""
    from fricmb.bench.stability import run_stability, stability_report

    chosen = Options(quick=options.quick, limit=options.limit)
    store = Store(options.out / "stability.jsonl", fingerprint(chosen))
    if options.again:
        store.clear()
    with _bar() as progress:
        result = {"about": about(chosen), **run_stability(options.quick, options.limit, store, progress)}
    _write(options.out, "stability.html", stability_report(result))
    _write(options.out, "stability.json", json.dumps(result, indent=1))
    bad = [row for row in result["grid"] if row["verdict"] in ("wrong", "crashed")]
    if options.json:
        print(json.dumps(result))
    else:
        for verdict, count in Counter(row["verdict"] for row in result["grid"]).most_common():
            print(f"{verdict:10} {count}")
        for row in bad:
            print(f"{row['verdict']}: {row['group']}: {row['value']}, {row['method']}")
        print(f"written: {options.out / 'stability.html'}, {options.out / 'stability.json'}")
    return 3 if bad else 0


@contextmanager
def _bar() -> Iterator[Callable[[int, int, str], None]]:
    """A progress bar on stderr."""
    from tqdm import tqdm

    with tqdm(unit="cell", file=sys.stderr, **({"dynamic_ncols": True} | bar_options())) as bar:

        def progress(done: int, total: int, what: str) -> None:
            bar.total = total
            bar.set_postfix_str(what, refresh=False)
            bar.update(done - bar.n)

        yield progress


def _write(folder: Path, name: str, text: str) -> None:
    make_folder(folder)
    (folder / name).write_text(text, encoding="utf-8")


def _summary(result: dict[str, Any], out: Path) -> None:
    print(f"{'scene':22} {'error':>6}  {'auto':>10}  {'best peer':>10}   (milliseconds)")
    for row in scoreboard([*result["cells"], *result["daes"]]):
        if row["auto"] or row["own"] or row["peer"]:
            own, peer = row["auto"] or row["own"], row["peer"]
            times = [f"{1e3 * cell['seconds']:10.3g}" if cell else f"{'-':>10}" for cell in (own, peer)]
            print(f"{row['case']:22} {row['level']:6.0e}  {times[0]}  {times[1]}   {peer['method'] if peer else ''}")
    found = tolerance_statistic(result["cells"])
    if found["runs"]:
        print(f"error / (rtol growth) within 0.01 to 100: {100 * found['within']:.0f} % of {found['runs']} runs")
    print(f"written: {out / 'report.html'}, {out / 'result.json'}")
