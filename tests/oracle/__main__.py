"""``python -m tests.oracle``: scenes from seeds, or the whole table of laws, against the oracle."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .judge import Truth, Worker, judge, truth
from .mechanisms import Chain
from .mechanisms import case_of as chain_case
from .problem import OracleError
from .random_scenes import KINDS, generate
from .shrink import BAD, shrunk
from .spec import case_of
from .table import LAWS, METHODS, SITUATIONS
from .table import case as cell
from .tally import Tally


def arguments() -> argparse.Namespace:
    """What the command takes."""
    parser = argparse.ArgumentParser(prog="python -m tests.oracle", description=__doc__)
    parser.add_argument("--minutes", type=float, default=30.0, help="for how long (default 30)")
    parser.add_argument("--scenes", type=int, default=10**9, help="at most so many")
    parser.add_argument("--seed", type=int, default=0, help="the first seed; scene by scene one more")
    parser.add_argument("--kinds", default=",".join(KINDS), help=f"of {', '.join(KINDS)}")
    parser.add_argument("--methods", default=",".join(METHODS), help=f"of {', '.join(METHODS)}")
    parser.add_argument("--rtol", type=float, default=1e-6)
    parser.add_argument("--limit", type=float, default=20.0, help="seconds of the processor for a run (default 20)")
    parser.add_argument("--table", action="store_true", help="every law in every situation in place of random scenes")
    parser.add_argument("--laws", default="", help="with --table: these alone")
    parser.add_argument("--shrink", action="store_true", help="look for a smaller scene that fails")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    return parser.parse_args()


def scenes(options: argparse.Namespace) -> Iterator[tuple[str, dict[str, Any], Any]]:
    """Kind, where it comes from, and the scene as data (None: a cell of the table)."""
    if options.table:
        for law in options.laws.split(",") if options.laws else LAWS:
            for situation in SITUATIONS:
                yield "table", {"law": law, "situation": situation}, None
        return
    kinds = options.kinds.split(",")
    for i in range(options.scenes):
        seed, kind = options.seed + i // len(kinds), kinds[i % len(kinds)]
        yield kind, {"kind": kind, "seed": seed}, generate(kind, seed)


def make(where: dict[str, Any], spec: Any) -> Any:
    """The scene in both forms."""
    if spec is None:
        return cell(where["law"], where["situation"])
    return chain_case(spec) if isinstance(spec, Chain) else case_of(spec)


def main() -> int:
    """Try scenes until the time is over; exit status 1 where a run was wrong."""
    options = arguments()
    worker, tally, start = Worker(options.limit), Tally(options.rtol, options.seed), time.monotonic()
    methods = options.methods.split(",")
    for kind, where, spec in scenes(options):
        minutes = (time.monotonic() - start) / 60.0
        if minutes > options.minutes:
            break
        try:
            true = truth(make(where, spec))
        except OracleError as error:
            tally.scene(kind, "undecided")
            print(*where.values(), "undecided:", error, flush=True)
            continue
        tally.scene(kind, "marginal" if true.marginal else "judged")
        if not true.marginal:
            runs(tally, true, methods, where, spec, worker, options)
        if options.json:
            tally.save(options.json, minutes)
    worker.stop()
    print(tally.text())
    return int(any(failure["verdict"] == "wrong" for failure in tally.failures))


def runs(
    tally: Tally, true: Truth, methods: list[str], where: dict[str, Any], spec: Any, worker: Worker,
    options: argparse.Namespace,
) -> None:  # fmt: skip
    """Every method on one scene."""
    for method in methods:
        verdict = judge(true, method, options.rtol, worker)
        found = dict(where)
        if verdict.kind in BAD:
            print(*where.values(), method, verdict.kind, f"{verdict.ratio:.2g}", verdict.wrong_transitions, verdict.why)
            if options.shrink and spec is not None and not isinstance(spec, Chain):
                found["smallest"] = shrunk(spec, method, options.rtol, worker).data()
                print("   smallest:", found["smallest"], flush=True)
        tally.run(method, verdict, found)


if __name__ == "__main__":
    raise SystemExit(main())
