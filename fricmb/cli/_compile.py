"""``fricmb compile``."""

from __future__ import annotations

import argparse
import time

from tqdm import tqdm

from fricmb._simulate._progress import bar_options
from fricmb.precompile import compile_all


def compile_ahead(options: argparse.Namespace) -> int:
    """Compile everything, with a bar that tells what is being made."""
    start = time.perf_counter()
    form = "{l_bar}{bar}| {n_fmt}/{total_fmt} {elapsed}{postfix}"
    with tqdm(disable=options.quiet, bar_format=form, **bar_options()) as bar:

        def report(task: str, done: int, total: int) -> None:
            bar.total, bar.n = total, done
            bar.set_postfix_str(task.rpartition(":")[2].rpartition(" ")[2])

        files = compile_all(processes=options.processes, into=options.into, report=report)
    if not options.quiet:
        print(f"{len(files)} files of machine code and equations are there, after {time.perf_counter() - start:.0f} s")
    return 0
