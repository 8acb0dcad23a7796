"""Random short runs, one after the other in one process and then in processes of a sweep: memory, files, processes.

    python tools/soak.py --runs 20000 --minutes 60

Each run is a model with values of its own, a method and a tolerance drawn at random; some are saved and read again,
some go on from the run before, some are made to fail. At regular times the resident memory (of all that is in use
after a collection of garbage), the open files, threads and child processes are noted. The last quarter of the runs may
use no more memory than the second, but for 2 %; files, threads and processes must be as many as before. The figures
are printed as JSON.
"""

from __future__ import annotations

import argparse
import gc
import json
import multiprocessing
import os
import random
import sys
import tempfile
import threading
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import fricmb as fm

#: Room for the spread of the allocator.
SLACK_MB, SLACK = 3.0, 0.02


def scene_of(rng: random.Random) -> tuple[fm.Scene, float]:
    """A scene and the length of its run."""
    kind = rng.randrange(7)
    mu = rng.uniform(0.1, 0.9)
    if kind == 0:
        return fm.models.brake4dof(rng.choice("12345"), mu_k_N=rng.uniform(5.0, 20.0)), rng.uniform(0.5, 5.0)
    if kind == 1:
        return fm.models.belt_oscillator(belt=rng.uniform(0.05, 0.5)), rng.uniform(1.0, 10.0)
    if kind == 2:
        return fm.models.stick_slip_chain(n=rng.randrange(2, 8), belt=rng.uniform(0.05, 0.3)), rng.uniform(0.5, 3.0)
    if kind == 3:
        return fm.models.puck_on_belt(mu=mu), rng.uniform(0.1, 1.0)
    if kind == 4:
        return fm.models.dry_pendulum(), rng.uniform(0.05, 0.3)
    if kind == 5:
        return fm.models.friction_oscillator(), rng.uniform(0.5, 3.0)
    law = rng.choice([fm.laws.Coulomb(mu_s=mu), fm.laws.Stribeck(mu_s=mu, mu_k=0.5 * mu, v_s=0.1)])
    block = fm.Body("block", mass=rng.uniform(0.5, 2.0), velocity={"x": rng.uniform(-1.0, 1.0)})
    spring = fm.Spring("k", block, axis="x", stiffness=rng.uniform(0.0, 10.0))
    return fm.Scene("block", [block, spring, fm.Contact("c", block, law=law, normal_force=1.0)]), rng.uniform(0.5, 5.0)


def one(rng: random.Random, folder: Path) -> fm.Solution | None:
    """One run; None where it was to fail or could not be made."""
    scene, length = scene_of(rng)
    method = rng.choice(("auto", "auto", "bdf", "radau"))
    options: dict[str, Any] = {"rtol": 10.0 ** -rng.uniform(3, 8), "method": method}
    if rng.random() < 0.3:
        options["t_eval"] = np.linspace(0.0, length, rng.randrange(2, 50))
    try:
        if rng.random() < 0.02:
            fm.simulate(scene, t_end=-1.0)
        sol = fm.simulate(scene, t_end=length, **options)
        if rng.random() < 0.1:
            sol = fm.simulate(scene, t_end=2.0 * length, initial=sol)
        if rng.random() < 0.1:
            sol.save(folder / "run.npz")
            again = fm.Solution.load(folder / "run.npz")
            assert np.array_equal(again(again.t_end), sol(sol.t_end))
        _ = sol.energy.residual, sol.events
    except (fm.SceneError, fm.IntegrationError):
        return None
    return sol


def in_use() -> dict[str, float]:
    """Resident memory in MB, open files, threads, child processes."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    return {
        "rss_mb": pages * os.sysconf("SC_PAGE_SIZE") / 1e6,
        "files": len(os.listdir("/proc/self/fd")),
        "threads": threading.active_count(),
        "processes": len(children) + len(multiprocessing.active_children()),
        "temporary": len(list(Path(tempfile.gettempdir()).glob("fricmb-*"))),
    }


def alone(count: int, minutes: float, seed: int, notes: int = 40) -> list[dict[str, float]]:
    """Runs in this process; what is in use, noted from time to time."""
    noted: list[dict[str, float]] = []
    end = time.monotonic() + 60.0 * minutes
    sol, failed = None, 0
    every = max(1, count // notes)
    with tempfile.TemporaryDirectory() as name:
        for i in range(count):
            sol = one(random.Random(f"{seed} {i}"), Path(name))
            failed += sol is None
            if (i + 1) % every == 0:
                noted.append({"runs": i + 1, "failed": failed, **in_use()})
                print(noted[-1], file=sys.stderr, flush=True)
            if time.monotonic() > end:
                break
    return noted


def last_value(sol: fm.Solution) -> float:
    """What a worker sends back."""
    return float(sol.q[0, -1])


def pooled(count: int, seed: int) -> dict[str, Any]:
    """Sweeps over processes, again and again; what is in use before and after."""
    before = in_use()
    rng = random.Random(seed)
    made = 0
    while made < count:
        scene, length = scene_of(rng)
        name = next(iter(scene.parameters))
        value = scene.parameters[name]
        runs = [{name: value * rng.uniform(0.9, 1.1)} if isinstance(value, float) else {} for _ in range(50)]
        made += len(fm.sweep(scene, runs, t_end=length, reduce=last_value, workers=2, progress=False, rtol=1e-4))
    return {"runs": made, "before": before, "after": in_use()}


def verdict(noted: list[dict[str, float]], pool: dict[str, Any]) -> list[str]:
    """What is not as it should be."""
    wrong = []
    quarters = np.array_split(np.array([row["rss_mb"] for row in noted]), 4)
    second, last = (float(np.median(quarters[i])) for i in (1, 3))
    if last > second * (1.0 + SLACK) + SLACK_MB:
        wrong.append(f"memory grows: {second:.1f} MB in the second quarter, {last:.1f} MB in the last")
    for what in ("files", "threads", "processes", "temporary"):
        if noted[-1][what] > noted[len(noted) // 4][what]:
            wrong.append(f"{what}: {noted[len(noted) // 4][what]} early on, {noted[-1][what]} at the end")
        if pool["after"][what] > pool["before"][what] + (what == "files"):
            wrong.append(f"{what} after sweeps: {pool['before'][what]}, then {pool['after'][what]}")
    return wrong


def main() -> int:
    """Run the command; status 1 where something leaks."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--runs", type=int, default=20_000)
    parser.add_argument("--minutes", type=float, default=60.0, help="end the runs in this process after that")
    parser.add_argument("--pool", type=int, default=500, help="runs in processes of sweeps")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    noted = alone(options.runs, options.minutes, options.seed)
    pool = pooled(options.pool, options.seed)
    wrong = verdict(noted, pool)
    print(json.dumps({"first": noted[0], "last": noted[-1], "pool": pool, "wrong": wrong}, indent=2))
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
