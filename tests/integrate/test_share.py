"""The first compilation, shared with a second process."""

import os
import subprocess
import sys

from fricmb.integrate.compile import parallel_compile
from fricmb.integrate.compile.block import block_module, cell, load_block
from fricmb.integrate.implicit import time_loop  # noqa: F401  (defines the blocks)

BLOCKS = ("lightness", "add_stick", "share_load")


def test_each_block_has_the_address_that_it_has_alone():
    parallel_compile.load_blocks(*BLOCKS)
    found = [cell(name).value for name in BLOCKS]
    assert len(set(found)) == len(BLOCKS)
    for name in BLOCKS:
        load_block(name)
    assert [cell(name).value for name in BLOCKS] == found


def test_a_pool_or_a_user_who_says_so_compiles_alone(monkeypatch):
    monkeypatch.setenv("FRICMB_COMPILE_PROCESSES", "1")
    assert parallel_compile._start_helper(BLOCKS) is None


def test_a_second_process_fills_the_cache(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "FRICMB_COMPILE_PROCESSES": "1"}
    arguments = [f"{block_module(name)}:{name}" for name in BLOCKS[:1]]
    subprocess.run([sys.executable, "-c", parallel_compile._COMMAND, *arguments], env=environment, check=True)
    assert list(tmp_path.rglob("*lightness*.nbc"))
