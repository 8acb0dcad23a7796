"""The whole suite: which cells there are, running them in order, going on after an interruption."""

from __future__ import annotations

import datetime
import hashlib
import json
import os
import platform
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fricmb as fm
from fricmb.bench._case import SceneCase
from fricmb.bench._cell import PATIENCE, Outcome, measure_cell
from fricmb.bench._dae_methods import dae_methods, measure_dae
from fricmb.bench._daes import dae_cases
from fricmb.bench._exudyn import exudyn_methods
from fricmb.bench._method import Method
from fricmb.bench._numbalsoda import numbalsoda_methods
from fricmb.bench._orders import configurations, measure_order
from fricmb.bench._own import own_methods
from fricmb.bench._run import Setting
from fricmb.bench._scenes import SCENES
from fricmb.bench._scipy import scipy_methods
from fricmb.bench._siconos import siconos_methods
from fricmb.bench._size import SIZES, measure_size, size_methods
from fricmb.bench._store import Store
from fricmb.bench._sundials import sundials_methods
from fricmb.bench._worker import CellEnded, Worker

#: Formulas of the quick suite.
_QUICK_ORDERS = ("bdf", "radau, stages 3", "collocation, nodes 7")

Progress = Callable[[int, int, str], None]


@dataclass(frozen=True, kw_only=True)
class Options:
    """What of the suite is run.

    Attributes
    ----------
    quick : bool
        Few scenes, three tolerances, one peer, small sizes.
    scenes : tuple of str
        Names of scenes, equations and size studies; empty: all.
    limit : float
        Seconds after which a cell is ended.
    """

    quick: bool = False
    scenes: tuple[str, ...] = ()
    limit: float = 60.0

    def wants(self, name: str, quick: bool = True) -> bool:
        """Whether the case of that name takes part."""
        return name in self.scenes if self.scenes else (quick or not self.quick)


@dataclass(frozen=True)
class Cell:
    """A thing to measure: ``family`` (scene, dae, size), case, method, setting; ``chain``: what is hard in order."""

    family: str
    case: str
    method: str
    setting: Setting
    n: int = 0

    @property
    def key(self) -> str:
        """Name in the store."""
        return f"{self.family}/{self.case}/{self.method}/{self.n or self.setting}"

    @property
    def row(self) -> str:
        """Cells of one row stand in order of difficulty."""
        return f"{self.family}/{self.case}/{self.method}"


def methods(quick: bool) -> list[Method]:
    """Integrators of fricmb, then the solvers of others that are installed."""
    if quick:
        peers = [peer for peer in (*scipy_methods(), *sundials_methods()) if peer.name in ("scipy LSODA", "CVODE")]
    else:
        peers = [peer for adapters in _ADAPTERS.values() for peer in adapters()]
    return [*own_methods(), *peers]


#: Adapters by what has to be installed for them.
_ADAPTERS: dict[str, Callable[[], list[Method]]] = {
    "scipy": scipy_methods,
    "scikit-sundae": sundials_methods,
    "numbalsoda": numbalsoda_methods,
    "exudyn": exudyn_methods,
    "siconos (or FRICMB_SICONOS, the interpreter that has it)": siconos_methods,
}


def missing() -> list[dict[str, str]]:
    """Peers that are left out, and what they need (case, method, why)."""
    return [
        {"case": "every scene", "method": name.split()[0], "why": f"not installed: {name}"}
        for name, adapters in _ADAPTERS.items()
        if not adapters()
    ]


def names() -> list[str]:
    """Everything that ``Options.scenes`` may name."""
    every: Iterator[Any] = iter((*SCENES, *dae_cases(), *SIZES))
    return [*(case.name for case in every), "order"]


def plan(options: Options) -> tuple[list[Cell], list[dict[str, str]]]:
    """The cells in order, and the refusals (case, method, why)."""
    cells: list[Cell] = []
    refusals = [] if options.quick else missing()
    for case in SCENES:
        if not options.wants(case.name, case.quick):
            continue
        for method in methods(options.quick):
            why = method.refuses(case)
            if why is not None:
                refusals.append({"case": case.name, "method": method.name, "why": why})
                continue
            settings = method.settings(case, options.quick)
            cells += [Cell("scene", case.name, method.name, setting) for setting in settings]
    for dae in dae_cases():
        if options.wants(dae.name, dae.quick):
            for solver in (method for method in dae_methods() if method.takes(dae)):
                cells += [Cell("dae", dae.name, solver.name, setting) for setting in solver.settings(options.quick)]
    if options.wants("order"):
        labels = [label for label, _ in configurations() if not options.quick or label in _QUICK_ORDERS]
        cells += [Cell("order", "order", label, Setting()) for label in labels]
    for size in SIZES:
        if options.wants(size.name):
            for name in size_methods(size) if not options.quick else ["auto"]:
                sizes = size.sizes[: size.quick] if options.quick else size.sizes
                cells += [Cell("size", size.name, name, Setting(rtol=1e-4), n) for n in sizes]
    return cells, refusals


def compile_named(cell: Cell) -> None:
    """Run what a cell compiles, once and without measuring."""
    if cell.family != "scene":
        measure_named(cell, patience=0.0)
        return
    case: SceneCase = next(case for case in SCENES if case.name == cell.case)
    next(method for method in methods(False) if method.name == cell.method).run(case, cell.setting, detail=False)


def measure_named(cell: Cell, patience: float = PATIENCE) -> dict[str, Any]:
    """Measure a cell (in whatever process); a plain dict."""
    if cell.family == "order":
        return measure_order(cell.method)
    if cell.family == "size":
        return measure_size(cell.case, cell.method, cell.n)
    if cell.family == "dae":
        dae = next(case for case in dae_cases() if case.name == cell.case)
        solver = next(method for method in dae_methods() if method.name == cell.method)
        return measure_dae(dae, solver, cell.setting).as_dict()
    case: SceneCase = next(case for case in SCENES if case.name == cell.case)
    method = next(method for method in methods(False) if method.name == cell.method)
    return measure_cell(case, method, cell.setting, patience).as_dict()


def run(options: Options, store: Store, progress: Progress | None = None) -> dict[str, Any]:
    """Measure what is not in the store; returns the whole result, for JSON and the report."""
    cells, refusals = plan(options)
    with Worker() as worker:
        if any(store.get(cell.key) is None for cell in cells):
            if progress is not None:
                progress(0, len(cells), "compiling")
            worker.warm(*_warming(cells))
        given_up: set[str] = set()
        for i, cell in enumerate(cells):
            if progress is not None:
                progress(i, len(cells), f"{cell.case}, {cell.method}")
            value = store.get(cell.key)
            if value is None:
                value = _measured(worker, cell, options, cell.row in given_up)
                store.put(cell.key, value)
            if "not done after" in value.get("failure", ""):
                given_up.add(cell.row)
        if progress is not None:
            progress(len(cells), len(cells), "")
    return {
        "about": about(options), "refusals": refusals,
        "cells": [store.get(cell.key) for cell in cells if cell.family == "scene"],
        "daes": [store.get(cell.key) for cell in cells if cell.family == "dae"],
        "orders": [store.get(cell.key) for cell in cells if cell.family == "order"],
        "sizes": [store.get(cell.key) for cell in cells if cell.family == "size"],
        "titles": titles(),
    }  # fmt: skip


def _warming(cells: list[Cell]) -> list[tuple[Callable[..., Any], tuple[Any, ...]]]:
    """For each method the first of its cells, the loosest: what it compiles is not to count against a limit."""
    first: dict[tuple[str, str], Cell] = {}
    for cell in cells:
        first.setdefault((cell.family, cell.method.partition(",")[0]), cell)
    return [(compile_named, (cell,)) for cell in first.values()]


def _measured(worker: Worker, cell: Cell, options: Options, given_up: bool) -> dict[str, Any]:
    try:
        if given_up:
            raise CellEnded("not tried: an easier setting was not done after the time limit")
        # a size is run once, and the last one counts
        limit = 3.0 * options.limit if cell.family == "size" else options.limit
        value: dict[str, Any] = worker.run(measure_named, cell, 0.1 if options.quick else PATIENCE, limit=limit)
        return value
    except CellEnded as error:
        failure = str(error)
    if cell.family in ("size", "order"):
        return {"case": cell.case, "method": cell.method, "n": cell.n, "failure": failure}
    own = {"solve_dae", "simulate", *(method.name for method in own_methods())}
    peer = cell.method not in own
    return Outcome(case=cell.case, method=cell.method, setting=cell.setting, peer=peer, failure=failure).as_dict()


def titles() -> dict[str, str]:
    """Title and source of every case."""
    every: Iterator[Any] = iter((*SCENES, *dae_cases()))
    return {case.name: f"{case.title} ({case.source})" for case in every} | {case.name: case.title for case in SIZES}


def about(options: Options) -> dict[str, Any]:
    """When, on what, with what."""
    import numba
    import numpy
    import scipy

    return {
        "date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "python": platform.python_version(),
        "versions": {"fricmb": fm.__version__, "numpy": numpy.__version__, "scipy": scipy.__version__,
                     "numba": numba.__version__,
                     **{name: _version(name) for name in ("scikit-sundae", "numbalsoda", "exudyn")}},
        "quick": options.quick, "limit": options.limit,
    }  # fmt: skip


def _version(package: str) -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def fingerprint(options: Options) -> str:
    """Changes with what makes earlier results those of something else: options, versions, the package's code."""
    digest = hashlib.sha256(json.dumps(about(options)["versions"]).encode())
    root = Path(fm.__file__).parent
    for path in sorted(root.rglob("*.py")):
        digest.update(path.read_bytes())
    return f"{options.quick}/{options.limit:g}/{digest.hexdigest()[:16]}"
