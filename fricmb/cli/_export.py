"""``fricmb export``: signals of a saved run for other programs."""

from __future__ import annotations

import argparse

import fricmb as fm
from fricmb.cli._output import make_folder
from fricmb.cli._plot import own_laws


def export(options: argparse.Namespace) -> int:
    """Write one file."""
    sol = fm.Solution.load(options.solution, laws=own_laws(options.laws))
    make_folder(options.out.parent)
    print(sol.export(options.out, None if options.signals is None else options.signals.split(",")))
    return 0
