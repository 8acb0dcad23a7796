"""One cell of the suite: a case, a method, a setting; what came out and what it cost."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from fricmb._simulate._compile_watch import CompileWatch
from fricmb.bench._case import SceneCase
from fricmb.bench._method import Method
from fricmb.bench._metrics import Metrics, measure
from fricmb.bench._run import Setting
from fricmb.bench._timed import timed
from fricmb.errors import FricmbError


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """A measured cell.

    Attributes
    ----------
    case, method : str
    setting : Setting
    metrics : Metrics or None
        None for a run that failed.
    seconds : float or None
        Least processor time of several runs in one process: on an idle machine the wall time, and unlike it hardly
        changed by what else runs.
    first : float or None
        Seconds spent compiling kernels, or loading them, in the first run; not part of ``seconds``.
    memory : float or None
        Megabytes by which the resident memory of the process rose at its highest, where the system tells.
    counters : dict
    used : str
    failure : str
        Why it failed, or "".
    """

    case: str
    method: str
    setting: Setting
    peer: bool = False
    metrics: Metrics | None = None
    seconds: float | None = None
    first: float | None = None
    memory: float | None = None
    counters: dict[str, int] = field(default_factory=dict)
    used: str = ""
    failure: str = ""

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Outcome:
        """Back from JSON."""
        metrics = data["metrics"]
        setting = Setting(**data["setting"])
        return cls(**{**data, "setting": setting, "metrics": None if metrics is None else Metrics(**metrics)})


#: Runs are repeated until this much time went by, at most this often.
PATIENCE, TRIES = 0.5, 7


def measure_cell(case: SceneCase, method: Method, setting: Setting, patience: float = PATIENCE) -> Outcome:
    """Run a cell: once with everything recorded, then for the time; a failure is an outcome."""
    known: dict[str, Any] = {"case": case.name, "method": method.name, "setting": setting, "peer": method.peer}
    try:
        with CompileWatch() as watch:
            run = method.run(case, setting, detail=True)
        metrics = measure(run, case.reference(), rows_of(case))
        seconds, memory = _timed(case, method, setting, patience)
    except (FricmbError, ArithmeticError, ValueError, RuntimeError, MemoryError) as error:
        return Outcome(**known, failure=one_line(error))
    return Outcome(
        **known, metrics=metrics, seconds=seconds, first=watch.seconds, memory=memory, counters=run.counters,
        used=run.used,
    )  # fmt: skip


def one_line(error: BaseException) -> str:
    """The message of an error with its type, in one line."""
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text[:300]}"


def rows_of(case: SceneCase) -> tuple[int, ...]:
    """Number of rows of each contact."""
    from fricmb.system import build

    return tuple(len(axes) for axes in build(case.build()).contact_axes)


def _timed(case: SceneCase, method: Method, setting: Setting, patience: float) -> tuple[float, float | None]:
    """Least processor time of several runs, and the rise of resident memory in the first of them."""
    before = _resident(reset=True)
    times: list[float] = []
    memory = None
    while not times or (sum(times) < patience and len(times) < TRIES):
        run, seconds = timed(lambda: method.run(case, setting, detail=False))
        times.append(seconds if run.seconds is None else run.seconds)
        highest = _resident(reset=False)
        if before is not None and highest is not None and len(times) == 1:
            memory = max(0.0, highest - before)
    return min(times), memory


def _resident(*, reset: bool) -> float | None:
    """Megabytes: with ``reset`` what is resident now, forgetting the highest; else the highest since (Linux alone)."""
    try:
        if reset:
            Path("/proc/self/clear_refs").write_text("5")
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return None
    name = "VmRSS:" if reset else "VmHWM:"
    return next((int(line.split()[1]) / 1024.0 for line in lines if line.startswith(name)), None)
