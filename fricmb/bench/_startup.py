"""Times of fresh processes: import, and the command on its default model."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence


def start_up_times(tries: int = 3) -> dict[str, float]:
    """Seconds, the least of a few tries, with caches as they are."""
    empty = _process_time([sys.executable, "-P", "-c", "pass"], tries)
    imported = _process_time([sys.executable, "-P", "-c", "import fricmb"], tries)
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "fricmb", "run", "brake4dof", "--out", folder]
        subprocess.run(command, check=True, capture_output=True)
        whole = _process_time(command, tries)
    return {"python alone": empty, "import fricmb, less python alone": imported - empty, "fricmb run brake4dof": whole}


def _process_time(command: Sequence[str], tries: int) -> float:
    times = []
    for _ in range(tries):
        begin = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        times.append(time.perf_counter() - begin)
    return min(times)
