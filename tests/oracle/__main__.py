"""``python -m tests.oracle``: scenes from seeds, or the whole table of laws, against the oracle; audits."""

from __future__ import annotations

import argparse
import itertools
import time
from pathlib import Path

from .audits import audit_all
from .campaign import begun, gathered, noted, tried
from .random_scenes import KINDS
from .shrink import BAD
from .table import METHODS
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
    parser.add_argument("--processes", type=int, default=1, help="so many scenes at once")
    parser.add_argument("--table", action="store_true", help="every law in every situation in place of random scenes")
    parser.add_argument("--audits", action="store_true", help="audits of the table's runs, and of wrong ones")
    parser.add_argument("--laws", default="", help="with --table or --audits: these alone")
    parser.add_argument("--shrink", action="store_true", help="look for a smaller scene that fails")
    parser.add_argument("--log", type=Path, help="one line a scene; scenes that are in it already are not tried again")
    parser.add_argument("--truths", type=Path, help="a folder for what the oracle says of scenes, to be read again")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    return parser.parse_args()


def main() -> int:
    """Try scenes until the time is over; exit status 1 where a run was wrong."""
    options = arguments()
    if options.audits:
        return audit_all(options.rtol, options.laws.split(",") if options.laws else (), options.minutes, options.json)
    tally, start = Tally(options.rtol, options.seed), time.monotonic()
    fresh = tried(options, 0, start) if options.processes == 1 else gathered(options, start)
    for found in itertools.chain(((item, False) for item in begun(options.log)), ((item, True) for item in fresh)):
        (kind, where, outcome, verdicts), new = found
        if new:
            noted(options.log, found[0])
        if outcome not in ("judged", "marginal"):
            print(*where.values(), "undecided:", outcome, flush=True)
            outcome = "undecided"
        tally.scene(kind, outcome)
        for method, verdict, extra in verdicts:
            if verdict.kind in BAD:
                print(
                    *where.values(), method, verdict.kind, f"{verdict.ratio:.2g}", verdict.wrong_transitions,
                    verdict.why, *extra.values(), flush=True,
                )  # fmt: skip
            tally.run(method, verdict, {**where, **extra})
        if options.json and new:
            tally.save(options.json, (time.monotonic() - start) / 60.0)
    print(tally.text())
    return int(any(failure["verdict"] == "wrong" for failure in tally.failures))


if __name__ == "__main__":
    raise SystemExit(main())
