"""Siconos: time stepping with a relay problem a step, set-valued friction without smoothing (an optional program).

It is asked through another interpreter, for it seldom lives in the same one as a recent numpy: the one that the
environment variable ``FRICMB_SICONOS`` names, else this one where ``siconos`` is installed.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from fricmb.bench import _siconos_run
from fricmb.bench._case import SceneCase
from fricmb.bench._method import Method
from fricmb.bench._peers import PeerError
from fricmb.bench._reference import Floats
from fricmb.bench._run import Run, Setting
from fricmb.integrate.problem import LAW_CONSTANT
from fricmb.system import System, build

#: Steps a unit of the reference's grid.
PARTS = (4, 16, 64, 256)
#: Most steps of a run.
MOST = 1_000_000


@dataclass(frozen=True)
class Siconos(Method):
    """EulerMoreauOSI with theta = 1/2 and Relay: linear scenes, contacts along one direction with mu_s = mu_k."""

    python: str
    name: str = "Siconos"
    peer: bool = True

    def settings(self, case: SceneCase, quick: bool) -> list[Setting]:
        """Steps that divide the spacing of the reference's grid."""
        t = case.reference().t
        spacing = case.t_end / 100.0 if len(t) == 1 else float(t[1] - t[0])
        found = [Setting(step=spacing / part) for part in PARTS]
        return [setting for setting in found if setting.step is not None and case.t_end / setting.step <= MOST]

    def refuses(self, case: SceneCase) -> str | None:
        """What a relay with a constant bound is not."""
        problem = build(case.build()).problem_for(0.0, case.t_end)
        contacts = problem.contacts
        if not case.peers:
            return "left out for its size"
        if len(problem.elements.table.address) or (contacts.normal != 0).any() or problem.m != problem.n_c:
            return "the adapter has linear scenes with contacts along one direction under constant forces"
        if (contacts.law != LAW_CONSTANT).any() or (contacts.mu_s != contacts.mu_0).any():
            return "a relay has one bound: mu_s = mu_k alone"
        if np.any(contacts.Wu) or len(problem.signals.breakpoints):
            return "the adapter has no driven motion and no jumps"
        return None

    def run(self, case: SceneCase, setting: Setting, *, detail: bool) -> Run:
        """Write the matrices, let the other interpreter step, read the states; ``seconds`` are those of its steps."""
        t = case.reference().t
        alone = len(t) == 1
        times = np.linspace(0.0, float(t[-1]), 101) if alone else t
        spacing = float(times[1] - times[0])
        every = max(1, round(spacing / (setting.step or spacing)))
        count = every * round(float(times[-1]) / spacing)
        system = build(case.build())
        n = system.problem.n
        with tempfile.TemporaryDirectory() as folder:
            source, target = Path(folder) / "in.npz", Path(folder) / "out.npz"
            arrays: dict[str, Any] = {"h": spacing / every, "count": count, "every": every}
            np.savez(source, **arrays, **_matrices(system, spacing / every, count))
            command = [self.python, _siconos_run.__file__, str(source), str(target)]
            try:
                done = subprocess.run(command, capture_output=True, text=True, check=False)
            except OSError as error:
                raise PeerError(f"Siconos: {error}") from None
            if done.returncode:
                raise PeerError(f"Siconos: {(done.stderr or done.stdout).strip().splitlines()[-1:]}")
            answer = np.load(target)
            states, forces, seconds = answer["states"].T, answer["forces"].T, float(answer["seconds"])
        if not np.isfinite(states).all() or states.shape[1] != len(times):
            raise PeerError("Siconos: the run did not reach its end")
        last = slice(-1, None) if alone else slice(None)
        q, v = states[:n, last], states[n:, last]
        if alone or not detail:
            return Run(q=q, v=v, seconds=seconds, counters={"n_steps": count})
        contacts = system.problem.contacts
        g = contacts.W.T @ v - contacts.w[:, None]
        forces[:, 0] = forces[:, 1]
        return Run(q=q, v=v, F=forces, g=g, seconds=seconds, counters={"n_steps": count})


def _matrices(system: System, h: float, count: int) -> dict[str, Any]:
    """X = [q, v]: A, C, B with the bounds in it, e, the loads (1 or steps, 2 n) at the middle of each step."""
    problem = system.problem
    n, linear, contacts = problem.n, problem.linear, problem.contacts
    inverse = np.linalg.inv(linear.M)
    A = np.zeros((2 * n, 2 * n))
    A[:n, n:] = np.eye(n)
    A[n:, :n], A[n:, n:] = -inverse @ linear.Kx[:n, :n], -inverse @ linear.Cx[:n, :n]
    limits = contacts.mu_0 * contacts.N
    B = np.vstack([np.zeros_like(contacts.W), inverse @ contacts.W * limits])
    C = np.hstack([np.zeros_like(contacts.W.T), contacts.W.T])
    middle: Floats = h * (np.arange(count, dtype=float) + 0.5) if problem.n_u else np.zeros(1)
    u = system.signals(middle)
    push = linear.fx[:n, None] + (linear.B - linear.Kx[:n, n:]) @ u[0] - linear.Cx[:n, n:] @ u[1]
    loads = np.vstack([np.zeros((n, len(middle))), inverse @ push]).T
    start = np.concatenate([system.start.q, system.start.v])
    return {"A": A, "B": B, "C": C, "e": -contacts.w, "limits": limits, "loads": loads, "start": start}


def siconos_methods() -> list[Method]:
    """The adapter where an interpreter with Siconos is known."""
    named = os.environ.get("FRICMB_SICONOS", "")
    if named:
        return [Siconos(named)]
    return [Siconos(sys.executable)] if find_spec("siconos") else []
