"""One of several processes that compile: tasks come in line by line, and what became of each goes out.

``python -m fricmb.precompile._worker``; a line is a task, an answer the seconds it took and the files it used, as JSON.
"""

from __future__ import annotations

import gc
import json
import os
import sys
import time


def main() -> None:
    """Serve until the input ends."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # whatever else is printed is no answer
    from fricmb.integrate.compile.cache_files import used_files
    from fricmb.integrate.compile.few_collections import few_collections
    from fricmb.precompile._tasks import do, kernels

    with few_collections():
        kernels()
        gc.freeze()
        for line in sys.stdin:
            start = time.perf_counter()
            do(line.strip())
            print(json.dumps({"seconds": time.perf_counter() - start, "files": used_files()}), file=answers, flush=True)


if __name__ == "__main__":
    main()
    # all that was made is on disk and told: to take half a gigabyte of compilers apart would take seconds
    os._exit(0)
