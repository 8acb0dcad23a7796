"""The cache folder: what is removed from it, what of it is believed, who can read it, what is left behind."""

import os
import shutil
import stat
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from fricmb.integrate.compile import cache_files
from fricmb.integrate.compile.cache_files import CacheFiles
from fricmb.integrate.compile.cache_trust import fault_of_folder

NOBODY = 65534
LONG_AGO = (1e9, 1e9)
root_only = pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="needs to become another user")
posix = pytest.mark.skipif(os.name == "nt", reason="owners and modes are asked on POSIX alone")


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """Files of a kind in a folder of their own, as a process meets them that has just begun."""
    monkeypatch.setenv("FRICMB_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.delenv("FRICMB_TEMPORARY_CACHE", raising=False)
    forget()
    yield begin
    forget()


def begin():
    forget()
    return CacheFiles("templates", r"\w+_[0-9a-f]{24}\.json", bytes, bytes, "derived again")


def forget():
    for one in (cache_files._folder, cache_files._temporary, cache_files._refusal, cache_files._say_once):
        one.cache_clear()


NAME = f"law_{'0' * 24}.json"
OTHER = f"law_{'1' * 24}.json"


def grow_old(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"a life's work")
    os.utime(path, LONG_AGO)
    return path


def test_what_is_a_strangers_stays_however_old(kept, tmp_path, monkeypatch):
    """A thesis in ./templates, a checkout called fricmb below NUMBA_CACHE_DIR, a cache of another program."""
    monkeypatch.setenv("FRICMB_CACHE_DIR", str(tmp_path))
    strangers = [grow_old(tmp_path / "templates" / name) for name in ("thesis.tex", "README.md", "draft.part", OTHER)]
    strangers.append(grow_old(tmp_path / "templates" / "__pycache__" / "a.pyc"))
    os.utime(tmp_path / "templates" / "__pycache__", LONG_AGO)
    kept().write(NAME, b"new")
    assert (tmp_path / "templates" / NAME).read_bytes() == b"new"
    assert [path for path in strangers if not path.exists()] == []
    # nor where another program has marked the folder as its cache
    (tmp_path / "templates" / "CACHEDIR.TAG").write_text("Signature: 8a477f597d28d172789f06886806bc55\n# another's\n")
    kept().write(NAME, b"new")
    assert [path for path in strangers if not path.exists()] == []


def test_of_a_marked_folder_what_was_made_here_goes_when_it_is_old(kept, tmp_path):
    folder = tmp_path / "cache" / "templates"
    kept().write(NAME, b"new")
    assert (folder / "CACHEDIR.TAG").read_text().startswith("Signature: 8a477f597d28d172789f06886806bc55\n")
    own = [grow_old(folder / name) for name in (OTHER, f"fricmb-{'a' * 16}.part")]
    strangers = [grow_old(folder / name) for name in ("thesis.tex", "law_1.json", f"{OTHER}.bak", "killed.part")]
    kept().write(NAME, b"newer")
    assert [path for path in own if path.exists()] == []
    assert [path for path in strangers if not path.exists()] == []
    assert (folder / "CACHEDIR.TAG").exists()


def test_the_names_of_kernels_and_templates_are_those_that_are_removed():
    from fricmb.equations import _store
    from fricmb.integrate.compile.kernel_cache import _files

    assert _store._files._is_own(f"{_store.key('law', 'x')}.json")
    assert _files._is_own(f"<lambda>-{'0' * 32}.nbc")
    for files in (_files, _store._files):
        assert not any(map(files._is_own, ("notes.json", "thesis.nbc", "a-b.nbc", "CACHEDIR.TAG", "x.part")))


@posix
@pytest.mark.parametrize("mode", [0o777, 0o757])
def test_a_folder_that_others_can_write_to_is_refused_with_a_line(kept, tmp_path, capsys, mode):
    folder = tmp_path / "cache" / "templates"
    kept().write(NAME, b"good")
    assert kept().read(NAME) == b"good"
    for place in (folder, folder.parent):
        place.chmod(mode)
        capsys.readouterr()
        files = kept()
        assert [files.read(NAME), files.read(NAME)] == [None, None]
        err = capsys.readouterr().err
        assert f"are not used, since {place} can be written by everybody" in err
        assert err.count("\n") == 1
        files.write(OTHER, b"mine")
        assert not (folder / OTHER).exists()
        assert files.read(OTHER) == b"mine"
        place.chmod(0o755)
    assert kept().read(NAME) == b"good"


@posix
def test_a_file_that_others_can_write_is_not_used(kept, tmp_path, capsys):
    path = tmp_path / "cache" / "templates" / NAME
    kept().write(NAME, b"good")
    path.chmod(0o666)
    assert kept().read(NAME) is None
    assert f"can be written by everybody, so it is not used and is derived again: {path}" in capsys.readouterr().err


@root_only
def test_what_belongs_to_another_user_is_not_used(kept, tmp_path, capsys):
    path = tmp_path / "cache" / "templates" / NAME
    kept().write(NAME, b"good")
    os.chown(path, NOBODY, NOBODY)
    assert kept().read(NAME) is None
    assert "belongs to user 65534" in capsys.readouterr().err
    kept().write(NAME, b"good")
    os.chown(path.parent, NOBODY, NOBODY)
    assert kept().read(NAME) is None
    assert f"{path.parent} belongs to user 65534" in capsys.readouterr().err


@root_only
def test_links_of_others_are_not_followed_and_a_sticky_folder_above_is_no_fault(tmp_path):
    own = tmp_path / "own"
    own.mkdir()
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o1777)
    (shared / "mine").mkdir()
    assert fault_of_folder(shared / "mine") is None
    assert "can be written by everybody" in fault_of_folder(shared)
    (shared / "link").symlink_to(own)
    assert fault_of_folder(shared / "link") is None
    os.chown(shared / "link", NOBODY, NOBODY, follow_symlinks=False)
    assert "link belongs to user 65534" in fault_of_folder(shared / "link" / "yet to be made")


@posix
@pytest.mark.parametrize(
    ("umask", "file", "folder"), [(0o022, 0o644, 0o755), (0o002, 0o644, 0o755), (0o077, 0o600, 0o700)]
)
def test_the_umask_says_who_can_read_and_others_can_never_write(kept, tmp_path, umask, file, folder):
    before = os.umask(umask)
    try:
        kept().write(NAME, b"good")
    finally:
        os.umask(before)
    path = tmp_path / "cache" / "templates" / NAME
    assert stat.S_IMODE(path.stat().st_mode) == file
    assert {stat.S_IMODE(place.stat().st_mode) for place in (path.parent, path.parent.parent)} == {folder}
    assert kept().read(NAME) == b"good"


#: Makes a template with its kernel in the cache of an image; as another user takes both from there.
IMAGE = """
import multiprocessing.util, os, shutil, sys
from fricmb.equations import _store
from fricmb._simulate._compile_watch import CompileWatch
import numpy as np

def answer(title):
    source = "'''%s'''" % title + '''
from fricmb.integrate.compile.template import template
from fricmb.integrate.compile.straight_line_codegen import straight
statements = straight("out[0] = %d.0*x[0]")
@template
def kernel(x, p, out):
    statements(x, p, out)
''' % (len(title))
    key = _store.key("test", title)
    derived = _store.read(key) is None
    if derived:
        _store.write(key, {}, source)
    x, out = np.array([3.0]), np.zeros(1)
    with CompileWatch() as watch:
        _store.function(_store.address(key))(x, x, out)
    return derived, watch.compiled, float(out[0])

image, own, user = sys.argv[1], sys.argv[2], int(sys.argv[3])
if user:
    os.environ["FRICMB_CACHE_DIR"], os.environ["FRICMB_QUIET"] = own, "1"
    answer("a first one, so that all modules are there")
    from fricmb.integrate.compile import cache_files
    for one in (cache_files._folder, cache_files._refusal):
        one.cache_clear()
    del os.environ["FRICMB_QUIET"]
    os.setgroups([])
    os.setgid(user)
    os.setuid(user)
os.environ["FRICMB_CACHE_DIR"] = image
print(answer("of the image"))
"""


@root_only
def test_a_cache_in_an_image_serves_every_user(monkeypatch):
    """Made by root and read-only for all others; they derive and compile nothing, and nothing is said."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    work = Path(tempfile.mkdtemp())  # those of pytest are for one user
    try:
        work.chmod(0o755)
        image = work / "image"

        def run(user):
            command = [sys.executable, "-c", IMAGE, image, tempfile.mkdtemp(dir=work), str(user)]
            done = subprocess.run(command, capture_output=True, text=True, timeout=120)
            assert done.returncode == 0, done.stderr
            return done.stdout.strip(), done.stderr

        assert run(0)[0] == "(True, True, 36.0)"
        before = {path: path.stat().st_mtime_ns for path in image.rglob("*")}
        assert run(NOBODY) == ("(False, False, 36.0)", "")
        assert {path: path.stat().st_mtime_ns for path in image.rglob("*")} == before
        # a cache that the user cannot read is said to be one
        for path in image.rglob("*"):
            path.chmod(0o700 if path.is_dir() else 0o600)
        found, said = run(NOBODY)
        assert found == "(True, True, 36.0)"
        assert f"templates in {image / 'templates'} cannot be read (Permission denied) and are derived again" in said
        assert f"kernels in {image / 'kernels'} cannot be read (Permission denied) and are compiled again" in said
    finally:
        shutil.rmtree(work)


LEFT = """
import os, sys
from fricmb.integrate.compile.cache_files import CacheFiles

files = CacheFiles("templates", "x", bytes, bytes, "derived again")
files.write("x", b"one")
print(files._other, flush=True)
if sys.argv[1] == "fork":
    if os.fork() == 0:
        sys.exit()
    os.wait()
    assert files.read("x") == b"one", "the fork's end removed it"
"""


@pytest.mark.parametrize("how", ["alone", pytest.param("fork", marks=posix)])
def test_a_temporary_cache_goes_with_its_process(tmp_path, how):
    (tmp_path / "file").write_text("")
    env = {**os.environ, "FRICMB_CACHE_DIR": str(tmp_path / "file"), "TMPDIR": str(tmp_path)}
    env.pop("FRICMB_TEMPORARY_CACHE", None)
    done = subprocess.run([sys.executable, "-c", LEFT, how], env=env, capture_output=True, text=True, check=True)
    assert done.stdout.startswith(str(tmp_path / "fricmb-"))
    assert "cannot be kept" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


SWEPT = """
import fricmb as fm
mass = fm.Body("mass", mass=1.0, position={"x": 1.0})
scene = fm.Scene("swinging", [mass, fm.Spring("spring", mass, axis="x", stiffness=1.0)])
def reduce(sol):
    from fricmb.integrate.compile.cache_files import CacheFiles
    CacheFiles("templates", "x", bytes, bytes, "derived again").write("x", b"one")
    return float(sol["mass.x"][-1])
if __name__ == "__main__":
    print(len(fm.sweep(scene, [{"spring.stiffness": 1.0}] * 2, t_end=0.5, reduce=reduce, workers=2, progress=False)))
"""


@pytest.mark.slow
def test_workers_of_a_sweep_leave_no_temporary_cache(tmp_path):
    """They are killed when all is done: what they keep is in a folder of the process that started them."""
    (tmp_path / "file").write_text("")
    (tmp_path / "script.py").write_text(SWEPT)
    env = {**os.environ, "FRICMB_CACHE_DIR": str(tmp_path / "file"), "TMPDIR": str(tmp_path)}
    env.pop("FRICMB_TEMPORARY_CACHE", None)
    done = subprocess.run(
        [sys.executable, tmp_path / "script.py"], env=env, capture_output=True, text=True, check=True, timeout=300
    )
    assert done.stdout.strip() == "2"
    assert sorted(path.name for path in tmp_path.iterdir() if path.name != "__pycache__") == ["file", "script.py"]


#: What a stranger may have put into the folder in which one happens to work.
TRAPS = ("random.py", "numpy.py", "numba.py", "json.py", "fricmb.py")


@pytest.fixture
def trap(tmp_path, monkeypatch):
    """A working folder with files that are called as modules are; gives the file that they make when they are run."""
    for name in TRAPS:
        (tmp_path / name).write_text(f"open({str(tmp_path / 'sprung')!r}, 'a').write({name!r})\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "sprung"


def test_processes_that_compile_take_nothing_from_the_working_folder(trap):
    from fricmb.precompile._crew import Crew

    answers = []
    with Crew(1) as crew:
        crew.work_off(["block lightness"], lambda task, answer: answers.append(answer))
    assert len(answers) == 1
    assert not trap.exists()


def test_the_helper_that_compiles_takes_nothing_from_the_working_folder(trap, monkeypatch):
    from fricmb.integrate.compile import parallel_compile
    from fricmb.integrate.implicit.equations.slip_rows import lightness

    assert lightness  # a block, known by its name once its module is there
    monkeypatch.delenv("FRICMB_COMPILE_PROCESSES", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    monkeypatch.setattr(parallel_compile, "FEWEST", 1)
    helper = parallel_compile._start_helper(("lightness",))
    assert helper is not None
    assert helper.wait(120) == 0
    assert not trap.exists()
