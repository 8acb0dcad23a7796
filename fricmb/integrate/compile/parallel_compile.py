"""The first compilation on a machine, shared with a second process.

Blocks are compiled and cached one by one, and numba compiles in one thread.  Where the first of them is not in the
cache, a second process compiles from the other end of the list, into the cache, until the two meet.  Whatever happens
to that process, this one takes each block from the cache or compiles it.
"""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
from functools import lru_cache

from fricmb.integrate.compile.block import block_module, load_block, was_compiled

#: The environment of a process that compiles for another one; numba tries overloads by letting them fail, and would set
#: each message in colours.
ALONE = {"FRICMB_COMPILE_PROCESSES": "1", "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1"}
#: Blocks from which on two processes pay: with three (Taylor steps) both were ready no sooner
#: than one alone, and worked 1.4 times as long, since much of what they compile is the same.
FEWEST = 4
_COMMAND = f"import sys; from {__name__} import compile_blocks; compile_blocks(sys.argv[1:])"


def compile_blocks(arguments: list[str]) -> None:
    """What the second process does; arguments: module and name of each block."""
    import importlib

    for module, name in (argument.split(":") for argument in arguments):
        importlib.import_module(module)
        load_block(name)


@lru_cache(maxsize=64)
def load_blocks(*blocks: str) -> None:
    """Load blocks, compiled by two processes where nothing is cached yet; once for all in a process.

    ``FRICMB_COMPILE_PROCESSES=1`` in the environment keeps it to this one; so do a process of a pool and few blocks.
    """
    helper = None
    try:
        for count, name in enumerate(blocks):
            load_block(name)
            if count == 0 and was_compiled(name):
                helper = _start_helper(blocks[:0:-1])
    finally:
        if helper is not None:
            # what it may still be at has been done here; numba writes its files atomically
            helper.terminate()
            helper.wait()


def _start_helper(blocks: tuple[str, ...]) -> subprocess.Popen[bytes] | None:
    alone = os.environ.get("FRICMB_COMPILE_PROCESSES") == "1" or multiprocessing.parent_process() is not None
    if alone or len(blocks) < FEWEST or (os.cpu_count() or 1) < 2 or not sys.executable:
        return None
    quiet = subprocess.DEVNULL
    arguments = [f"{block_module(name)}:{name}" for name in blocks]
    try:
        return subprocess.Popen(
            [sys.executable, "-P", "-c", _COMMAND, *arguments],  # -P: nothing from the working folder
            stdin=quiet,
            stdout=quiet,
            stderr=quiet,
            env={**os.environ, **ALONE},
        )
    except OSError:
        return None
