"""A run does not load numpy's translator of Fortran, which is there for who uses it."""

import subprocess
import sys

import pytest

BEFORE = "import fricmb as fm, sys; fm.simulate(fm.models.belt_oscillator(), t_end=0.01)\n"


@pytest.mark.parametrize(
    "use",
    [
        "import numpy; assert numpy.f2py.get_include()",
        "from numpy import f2py; assert f2py.run_main",
        "import numpy.f2py.crackfortran as c; assert c.crackfortran",
    ],
)
def test_f2py_is_loaded_when_it_is_used(use):
    put_off = "assert 'numpy.f2py.crackfortran' not in sys.modules\n"
    subprocess.run([sys.executable, "-c", f"{BEFORE}{put_off}{use}"], check=True)


def test_f2py_that_is_loaded_stays():
    text = f"import numpy.f2py; held = numpy.f2py\n{BEFORE}assert sys.modules['numpy.f2py'] is held is numpy.f2py"
    subprocess.run([sys.executable, "-c", text], check=True)
