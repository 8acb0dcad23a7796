"""What the build adds to pyproject.toml: kernels are compiled when the package is built, unless FRICMB_COMPILE=0."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

#: What kernels need to be compiled: what runs need, but for pictures, and for what is done in Python before a run.
#: Models' equations are derived at their first run, in less time than it takes to install SymPy for the build alone.
PROJECT = tomllib.loads(Path(__file__).with_name("pyproject.toml").read_text())["project"]
NEEDED = [need for need in PROJECT["dependencies"] if not need.startswith(("matplotlib", "scipy", "sympy"))]
#: Seconds after which compiling is given up.
LIMIT = 1800
#: Otherwise each kernel is compiled at its first use.
WANTED = os.environ.get("FRICMB_COMPILE", "1") != "0"


class BuildWithKernels(build_py):
    """Copies the sources, then lets the package compile its kernels into the copy.

    Whatever goes wrong there, the package is built all the same: what is missing is compiled at its first use.
    """

    def run(self):
        """Copy, then compile."""
        super().run()
        if WANTED and not self.editable_mode:
            built = Path(self.build_lib).resolve()
            command = [sys.executable, "-P", "-m", "fricmb", "compile", "--into", str(built / "fricmb" / "_made")]
            paths = [str(built), *filter(None, [os.environ.get("PYTHONPATH")])]
            try:
                env = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
                subprocess.run(command, cwd=built, env=env, check=True, timeout=LIMIT)
            except (OSError, subprocess.SubprocessError) as error:
                print(f"kernels are not compiled ahead of use: {error}", file=sys.stderr)

    def get_outputs(self, include_bytecode=1):
        """Sources, and what was compiled."""
        made = Path(self.build_lib) / "fricmb" / "_made"
        return [*super().get_outputs(include_bytecode), *(str(path) for path in made.rglob("*") if path.is_file())]


class WithMachineCode(Distribution):
    """Its wheels are for one processor and one Python."""

    def has_ext_modules(self):
        """Whether the wheel holds machine code."""
        return WANTED


setup(
    cmdclass={"build_py": BuildWithKernels},
    distclass=WithMachineCode,
    setup_requires=NEEDED if WANTED else [],  # of the build, by its frontend
)
