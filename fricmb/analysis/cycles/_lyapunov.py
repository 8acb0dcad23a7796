"""Lyapunov exponents of motion through stick and slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb._calls import answers
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options
from fricmb._simulate._progress import bar
from fricmb.analysis._errors import Floats, checked_integer, checked_kind, checked_number, positive
from fricmb.analysis.cycles._flow import check_scene
from fricmb.solution import Solution

if TYPE_CHECKING:
    from fricmb.scene import Scene

_WHO = "lyapunov"
#: Most intervals.
_MOST = 10_000_000
#: A direction that shrinks to this part of the largest within one interval has been cut off by a landing.
_CUT = 1e-12


@dataclass(frozen=True, kw_only=True)
class Lyapunov:
    """Lyapunov exponents of a run.

    Attributes
    ----------
    exponents : (n_y,)
        Largest first; -inf for directions that an end of slip has wiped out.
    t : (n,)
        Times of the estimates.
    running : (n, n_y)
        Estimates up to each of these times, which show how far they have settled.
    solution : Solution
        The last interval, from which a further run can continue.
    """

    exponents: Floats
    t: Floats
    running: Floats
    solution: Solution

    @property
    def dimension(self) -> float:
        """Kaplan-Yorke dimension of the attractor; sums count as 0 to a hundredth of one over the length of the run."""
        sums = np.cumsum(self.exponents)
        length = self.t[-1] - self.t[0] + np.diff(self.t[:2]).sum()
        j = int((sums >= -0.01 / max(float(length), 1e-300)).sum())
        if j == 0 or j == sums.size or not np.isfinite(self.exponents[j]):
            return float(j)
        return float(j + sums[j - 1] / abs(self.exponents[j]))

    def __str__(self) -> str:
        shown = ", ".join(f"{value:.4g}" for value in self.exponents)
        return f"Lyapunov exponents {shown}; dimension {self.dimension:.4g}"


@answers
def lyapunov(
    scene: Scene,
    *,
    t_end: float,
    start: Solution | None = None,
    intervals: int = 200,
    discard: float = 0.1,
    rtol: float = 1e-8,
    progress: bool = True,
    **options: Any,
) -> Lyapunov:
    """Lyapunov exponents: mean rates at which small deviations grow.

    Parameters
    ----------
    scene : Scene
    t_end : float
        Length of the run over which rates are averaged, without the part that is discarded.
    start : Solution, optional
        A run to go on from.
    intervals : int
        Number of intervals after each of which the deviations are made orthogonal again.
    discard : float
        Length of the part run before, as a share of ``t_end``, for the motion and the directions to settle.
    rtol : float
    progress : bool
        Show a bar on the terminal.
    **options
        As :func:`fricmb.simulate`.

    Returns
    -------
    Lyapunov

    Raises
    ------
    AnalysisError
        For mechanisms, and arguments that are not accepted.

    Notes
    -----
    The exact derivative of each interval is decomposed by QR (G. Benettin, L. Galgani, A. Giorgilli and
    J.-M. Strelcyn, Meccanica 15 (1980) 9-30).  Where slip ends a deviation of the slip velocity is gone for good: the
    derivative loses a rank, and the exponent of that direction is -inf.  An autonomous motion that is no equilibrium
    has one exponent 0.
    """
    check_scene(scene, _WHO)
    t_end, intervals = positive(_WHO, "t_end", t_end), checked_integer(_WHO, "intervals", intervals, 1, _MOST)
    discard = checked_number(_WHO, "discard", discard, "a number of at least 0", lambda x: x >= 0.0)
    if start is not None:
        checked_kind(_WHO, "start", start, Solution, "a Solution")
    own = ("t_end", "t_start", "initial", "sensitivities", "rtol", "on_chunk", "chunk")
    check_options(_WHO, options, simulate, *own, call=lyapunov)
    step = t_end / intervals
    before = int(np.ceil(discard * intervals))
    options = {"rtol": rtol, **options}
    run, Q = start, np.zeros((0, 0))
    sums, elapsed, times, running = np.zeros(0), 0.0, [], []
    with bar(before + intervals, "interval", "lyapunov", progress) as shown:
        for i in range(before + intervals):
            t = 0.0 if run is None else run.t_end
            run = simulate(scene, t_end=t + step, initial=run, sensitivities="state", **options)
            Phi = run.monodromy
            if i == 0:
                Q, sums = np.eye(len(Phi)), np.zeros(len(Phi))
            Q, growth = _grown(Phi, Q)
            if i == before:
                sums, elapsed = np.zeros(len(Phi)), 0.0
            sums = sums + growth
            elapsed += step
            if i >= before:
                times.append(run.t_end)
                running.append(np.sort(sums / elapsed)[::-1])
            shown.update()
    assert run is not None
    return Lyapunov(exponents=running[-1], t=np.array(times), running=np.array(running), solution=run)


def _grown(Phi: Floats, Q: Floats) -> tuple[Floats, Floats]:
    """Deviations after an interval, orthogonal again, and the logarithms (n_y,) of their growth."""
    new, R = np.linalg.qr(Phi @ Q)
    size = np.abs(np.diag(R))
    kept = size > _CUT * np.abs(R).max(initial=0.0)
    growth = np.full(len(Phi), -np.inf)
    growth[: kept.sum()] = np.log(size[kept])
    return new[:, kept], growth
