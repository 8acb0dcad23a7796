"""What the build adds to pyproject.toml: kernels are compiled when the package is built, unless FRICMB_COMPILE=0."""

import atexit
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import tomllib
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

#: What kernels need to be compiled: what runs need, but for pictures, and for what is done in Python before a run.
#: Models' equations are derived at their first run, in less time than it takes to install SymPy for the build alone.
PROJECT = tomllib.loads(Path(__file__).with_name("pyproject.toml").read_text())["project"]
NEEDED = [need for need in PROJECT["dependencies"] if not need.startswith(("matplotlib", "networkx", "scipy", "sympy"))]
#: Seconds after which compiling is given up.
LIMIT = 1800
#: Otherwise each kernel is compiled at its first use.
WANTED = os.environ.get("FRICMB_COMPILE", "1") != "0"


class BuildWithKernels(build_py):
    """Copies the sources, then lets the package compile its kernels into the copy.

    Whatever goes wrong there, the package is built all the same: what is missing is compiled at its first use, which
    says what went wrong here, since pip shows nothing of a build.
    """

    def run(self):
        """Copy, then compile."""
        built = Path(self.build_lib).resolve()
        if not self.editable_mode:  # what a build before left there may have been deleted or compiled from since
            shutil.rmtree(built / "fricmb", ignore_errors=True)
        super().run()
        if self.editable_mode:
            return
        made = built / "fricmb" / "_made"
        why = compiled_into(made) if WANTED else "FRICMB_COMPILE=0 was set"
        self.distribution.has_kernels = why is None
        if why is not None:
            print(f"kernels are not compiled ahead of use: {why}", file=sys.stderr)
            shutil.rmtree(made, ignore_errors=True)
            made.mkdir()
            (made / "why_none.txt").write_text(why, encoding="utf-8")

    def get_outputs(self, include_bytecode=1):
        """Sources, and what was compiled."""
        made = Path(self.build_lib) / "fricmb" / "_made"
        return [*super().get_outputs(include_bytecode), *(str(path) for path in made.rglob("*") if path.is_file())]


def compiled_into(made):
    """Compile all kernels into a folder of a built package; None, or why there are none."""
    built = made.parents[1]
    command = [sys.executable, "-P", "-m", "fricmb", "compile", "--into", str(made)]
    paths = [str(built), *filter(None, [os.environ.get("PYTHONPATH")])]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    try:
        process = subprocess.Popen(command, cwd=built, env=env, stderr=subprocess.PIPE, text=True, errors="replace")
    except OSError as error:
        return str(error)
    late = threading.Event()
    timer = threading.Timer(LIMIT, lambda: (late.set(), process.kill()))
    timer.start()
    last = ""
    for line in process.stderr:  # shown by `pip install -v`, that of the bar included
        print(line, end="", file=sys.stderr, flush=True)
        last = line.strip() or last
    timer.cancel()
    if process.wait() == 0:
        return None
    return f"it took more than {LIMIT} s" if late.is_set() else last or f"it ended with status {process.returncode}"


class WheelOfWhatWasMade(bdist_wheel):
    """Its name tells of one processor and one Python only if there is machine code in it."""

    def run(self):
        """Build first, for only then it is known."""
        if not self.skip_build:
            self.run_command("build")
            self.root_is_pure = not self.distribution.has_ext_modules()
        super().run()


class WithMachineCode(Distribution):
    """Its wheels are for one processor and one Python, if they hold kernels."""

    #: Whether there are; None: not known yet.
    has_kernels = None

    def has_ext_modules(self):
        """Whether the wheel holds machine code: none does that was made for an editable install."""
        if "editable_wheel" in self.commands:
            return False
        return WANTED if self.has_kernels is None else self.has_kernels


def fresh_folders():
    """Where a build puts what it makes: two may go on at once from one clone, and none finds what another left."""
    fresh = tempfile.mkdtemp(prefix="fricmb-build-")
    atexit.register(shutil.rmtree, fresh, ignore_errors=True)
    options = {"build": {"build_base": fresh}}
    if "bdist_wheel" in sys.argv:  # an sdist takes what it is told from the source's own folder
        options["egg_info"] = {"egg_base": fresh}
    return options


setup(
    cmdclass={"build_py": BuildWithKernels, "bdist_wheel": WheelOfWhatWasMade},
    distclass=WithMachineCode,
    options=fresh_folders(),
    setup_requires=NEEDED if WANTED else [],  # of the build, by its frontend
)
