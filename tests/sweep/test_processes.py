"""Processes of a sweep that are killed, take too long, or lose their parent; Ctrl-C once and twice."""

import os
import signal
import sqlite3
import subprocess
import sys
import textwrap
import time
import types
from pathlib import Path

import pytest

import fricmb as fm
from fricmb._sweep import _processes, _workers
from fricmb._sweep._processes import run_in_processes


def square(value):
    """What a run does; some values end their process, or hang."""
    if value["x"] == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if value["x"] == "leave":
        os._exit(7)
    if value["x"] == "hang":
        time.sleep(600)
    if value["x"] == "raise":
        raise KeyError("no such thing")
    if value["x"] == "closure":
        return lambda: None
    return value["x"] ** 2


def run(values, count=2, limit=None):
    found = dict(run_in_processes(square, {i: {"x": x} for i, x in enumerate(values)}, count, limit))
    return [found[i] for i in range(len(values))]


def test_a_killed_process_costs_its_run(capfd):
    found = run([1, "die", 3, "leave", 5, 6])
    assert [x for x in found if not isinstance(x, fm.IntegrationError)] == [1, 9, 25, 36]
    assert "was killed (out of memory?)" in str(found[1])
    assert "status 7" in str(found[3])
    assert capfd.readouterr().err.count("has no result") == 2


def test_a_run_that_takes_too_long_is_ended(capfd):
    found = run([1, "hang", 3, "hang"], limit=0.5)
    assert [found[0], found[2]] == [1, 9]
    assert all(isinstance(found[i], fm.IntegrationError) and "more than 0.5 s" in found[i].reason for i in (1, 3))
    assert "run_limit" in capfd.readouterr().err


def test_errors_and_results_that_cannot_be_sent():
    with pytest.raises(KeyError, match="no such thing"):
        run([1, "raise", 3])
    with pytest.raises(fm.FricmbError, match="cannot be sent from a worker process"):
        run([1, "closure"])


def test_the_store_does_not_keep_what_was_ended(tmp_path, monkeypatch):
    options = {"t_end": 1.0, "workers": 2, "progress": False, "store": tmp_path / "runs", "run_limit": 60.0}
    mass = fm.Body("mass", mass=1.0)
    scene = fm.Scene("s", [mass, fm.Spring("k", mass, axis="x", stiffness=1.0)])
    flag = tmp_path / "flag"

    def once(self, parameters):
        if parameters["k.stiffness"] == 2.0 and not flag.exists():
            flag.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return parameters["k.stiffness"]

    monkeypatch.setattr(_workers.Job, "run", once)
    values = [{"k.stiffness": x} for x in (1.0, 2.0, 3.0)]
    first = fm.sweep(scene, values, **options)
    assert isinstance(first[1], fm.IntegrationError)
    assert fm.sweep(scene, values, **options) == [1.0, 2.0, 3.0]


SCRIPT = """
    import os, signal, sys, time
    signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background may be told to ignore it
    from fricmb._sweep._processes import run_in_processes

    def work(value):
        open(os.path.join(sys.argv[1], f"{os.getpid()}.pid"), "w").close()
        time.sleep(value["x"])
        return value["x"]

    if __name__ == "__main__":
        for i, result in run_in_processes(work, {i: {"x": float(sys.argv[2])} for i in range(4)}, 2, None):
            print(i, flush=True)
"""


@pytest.fixture
def started(tmp_path):
    """A sweep in another process, its two workers at a run that takes so many seconds."""
    (tmp_path / "script.py").write_text(textwrap.dedent(SCRIPT))
    processes = []

    def start(seconds):
        command = [sys.executable, str(tmp_path / "script.py"), str(tmp_path), str(seconds)]
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        processes.append(process)
        wait_for(lambda: len(list(tmp_path.glob("*.pid"))) == 2)
        return process, [int(path.stem) for path in tmp_path.glob("*.pid")]

    yield start
    for process in processes:
        process.kill()
        process.communicate()


def wait_for(true, seconds=60):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.05)


def alive(pid):
    """Whether a process runs (one that nobody has asked after counts as ended)."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


linux = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")


@linux
def test_workers_end_with_their_parent(started):
    process, workers = started(600)
    assert all(map(alive, workers))
    process.kill()
    wait_for(lambda: not any(map(alive, workers)))


@linux
def test_ctrl_c_waits_for_what_is_under_way_and_a_second_one_does_not(started):
    process, workers = started(600)
    os.killpg(process.pid, signal.SIGINT)
    time.sleep(1.0)
    assert process.poll() is None
    assert all(map(alive, workers)), "the runs go on"
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=300)  # they would go on for 600 s
    assert "waiting for 2 runs" in err
    wait_for(lambda: not any(map(alive, workers)))


@linux
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGHUP])
def test_what_ends_a_job_is_taken_as_ctrl_c(tmp_path, how):
    """A batch system sends SIGTERM to all processes of a job, a terminal that is closed SIGHUP."""
    (tmp_path / "script.py").write_text(textwrap.dedent(SWEEP))
    command = [sys.executable, str(tmp_path / "script.py"), str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        wait_for(lambda: len(list(tmp_path.glob("*.pid"))) == 2)
        process.send_signal(how)
        for path in tmp_path.glob("*.pid"):
            os.kill(int(path.stem), how)
        out, err = process.communicate(timeout=60)
    assert "waiting for 2 runs under way" in err
    assert "2 of 6 runs are done, kept in" in err
    assert out.strip() == "[0.0, 1.0, None, None, None, None]"
    base = sqlite3.connect(tmp_path / "runs" / "results.sqlite")
    assert base.execute("SELECT count(*) FROM results").fetchone() == (2,)
    base.close()


SWEEP = """
    import os, signal, sys, time
    # as in the background of a shell: Ctrl-C is ignored there
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # what is started by nohup is told to ignore it
    import fricmb as fm
    from fricmb._sweep import _processes, _workers

    def work(self, value):
        open(os.path.join(sys.argv[1], f"{os.getpid()}.pid"), "w").close()
        time.sleep(2.0)
        return value["k.stiffness"]

    if __name__ == "__main__":
        _workers.Job.run = work
        mass = fm.Body("mass", mass=1.0)
        scene = fm.Scene("s", [mass, fm.Spring("k", mass, axis="x", stiffness=1.0)])
        runs = [{"k.stiffness": float(x)} for x in range(6)]
        before = [signal.getsignal(one) for one in (signal.SIGTERM, signal.SIGHUP)]
        try:
            fm.sweep(scene, runs, t_end=1.0, workers=2, progress=False, store=os.path.join(sys.argv[1], "runs"))
        except KeyboardInterrupt as stop:
            print(stop.results)
        assert before == [signal.getsignal(one) for one in (signal.SIGTERM, signal.SIGHUP)]
"""


def test_a_process_ends_on_windows_too(monkeypatch, capfd):
    """Which has no SIGKILL: its name alone ended the sweep when a worker had died."""
    there = {name: held for name, held in vars(signal).items() if name != "SIGKILL"}
    monkeypatch.setattr(_processes, "signal", types.SimpleNamespace(**there))
    found = run([1, "leave", 3])
    assert [found[0], found[2]] == [1, 9]
    assert "status 7" in str(found[1])


@linux
def test_after_ctrl_c_what_is_under_way_is_kept(started):
    process, _ = started(3)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert sorted(out.split()) == ["0", "1"]
    assert err.rstrip().endswith("KeyboardInterrupt")


def test_an_interrupted_sweep_says_how_to_go_on(tmp_path, monkeypatch, capsys):
    mass = fm.Body("mass", mass=1.0)
    scene = fm.Scene("s", [mass, fm.Spring("k", mass, axis="x", stiffness=1.0)])

    def stopped(self, parameters):
        if parameters["k.stiffness"] == 2.0:
            raise KeyboardInterrupt
        return 7

    monkeypatch.setattr(_workers.Job, "run", stopped)
    for store, said in ((None, "give store="), (tmp_path / "runs", "the same call goes on from there")):
        with pytest.raises(KeyboardInterrupt) as stop:
            fm.sweep(
                scene, [{"k.stiffness": x} for x in (1.0, 2.0)], t_end=1.0, workers=1, progress=False, store=store
            )
        assert stop.value.results == [7, None]
        assert f"1 of 2 runs are done, kept {'nowhere' if store is None else 'in'}" in (err := capsys.readouterr().err)
        assert said in err
