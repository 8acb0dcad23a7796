"""The command: what it prints, what it writes, how it ends."""

import csv
import json
import subprocess
import sys

import numpy as np
import pytest

import fricmb as fm
from fricmb.cli import main
from fricmb.scene import Part


def run(capsys, *arguments):
    """Exit status, stdout, stderr; argparse leaves through SystemExit."""
    try:
        status = main([str(a) for a in arguments])
    except SystemExit as leaving:
        status = leaving.code
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_run_writes_summary_data_and_pictures(capsys, tmp_path):
    out = tmp_path / "belt"
    status, text, _ = run(capsys, "run", "belt_oscillator", "--t-end", 40, "--out", out)
    assert status == 0
    for word in ("stick", "friction", "residual", "steps"):
        assert word in text
    summary = json.loads((out / "summary.json").read_text())
    assert summary["contacts"]["sole"]["events"]["slip"] == 2
    assert 0.7 < summary["contacts"]["sole"]["stick_share"] < 0.9
    assert abs(summary["energy"]["residual"]) < 1e-5
    for name in ("velocities", "phase", "force", "transitions", "energy"):
        assert (out / f"{name}.png").read_bytes()[:4] == b"\x89PNG"
    with (out / "solution.csv").open() as file:
        rows = list(csv.DictReader(file))
    sol = fm.Solution.load(out / "solution.npz")
    assert np.array([float(row["mass.x"]) for row in rows]) == pytest.approx(sol["mass.x"], abs=0)
    assert {"t", "mass.x", "mass.x.velocity", "sole.force.x", "sole.mode"} <= set(rows[0])
    with (out / "events.csv").open() as file:
        assert [row["kind"] for row in csv.DictReader(file)] == [event.kind for event in sol.events]


def test_csv_columns_are_those_of_pandas(tmp_path, capsys):
    run(capsys, "run", "puck_on_belt", "--no-plots", "--out", tmp_path)
    header = (tmp_path / "solution.csv").read_text().partition("\n")[0].split(",")
    frame = fm.Solution.load(tmp_path / "solution.npz").to_pandas()
    assert set(frame.columns) <= set(header) | {"t"}


def test_json_is_all_there_is_on_stdout(capsys, tmp_path):
    status, text, _ = run(
        capsys, "run", "puck_on_belt", "--json", "--no-plots", "--out", tmp_path, "--set", "mu=0.5", "--points", 11
    )
    assert status == 0
    summary = json.loads(text)
    assert summary["final"]["velocity"]["puck.x"] == pytest.approx(1.0)
    assert not list(tmp_path.glob("*.png"))
    assert len((tmp_path / "solution.csv").read_text().splitlines()) == 12


def test_settings_reach_the_model_and_the_scene(capsys, tmp_path):
    status, text, _ = run(
        capsys, "run", "brake4dof", "--case", "5", "--set", "delta=0.5", "--set", "rotor.velocity.x=2.5",
        "--t-end", 1, "--json", "--no-plots", "--out", tmp_path,
    )  # fmt: skip
    assert status == 0
    assert json.loads(text)["scene"] == "brake4dof case 5"
    scene = fm.Solution.load(tmp_path / "solution.npz").scene
    assert scene.parameters["c1x.damping"] == 0.5
    assert scene.parameters["rotor.velocity.x"] == 2.5


SCENE = """
import fricmb as fm

block = fm.Body("block", mass=2.0, velocity={"x": 1.0})
scene = fm.Scene("sliding block", [block, fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=4.0)])
t_end = 2.0
"""


def test_a_file_is_a_model(capsys, tmp_path):
    file = tmp_path / "sliding.py"
    file.write_text(SCENE)
    status, text, _ = run(capsys, "run", file, "--set", "block.velocity.x=1.5", "--no-plots", "--out", tmp_path / "out")
    assert status == 0
    assert "sliding block" in text
    sol = fm.Solution.load(tmp_path / "out" / "solution.npz")
    assert sol.events[0].t == pytest.approx(1.5, abs=1e-7)
    assert sol.t[-1] == 2.0


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["run", "brake4dov"], "did you mean 'brake4dof'"),
        (["run", "brake4dof", "--case", "7"], "case must be one of 1, 2, 3, 3b, 4, 5"),
        (["run", "belt_oscillator", "--case", "1"], "belt_oscillator has no cases"),
        (["run", "brake4dof", "--set", "delta"], "expected NAME=VALUE; got 'delta'"),
        (["run", "brake4dof", "--set", "k2y.stifness=3"], "k2y.stiffness"),
        (["run", "brake4dof", "--set", "k2y.stiffness=soft"], "takes a number; got 'soft'"),
        (["run", "brake4dof", "--set", "Omega1=fast"], "Omega1 must be a finite number or None; got 'fast'"),
        (["run", "brake4dof", "--set", "mass_ratio=-2"], "mass"),
        (["run", "brake4dof", "--t-end", "-1"], "--t-end"),
        (["run", "brake4dof", "--t-end", "nan"], "--t-end"),
        (["run", "brake4dof", "--points", "1"], "--points"),
        (["run", "brake4dof", "--rtol", "-1"], "rtol"),
        (["run", "brake4dof", "--method", "euler"], "euler"),
        (["run", "no/such/file.py"], "there is no file 'no/such/file.py'"),
        (["plan", "brake4dov"], "brake4dof"),
        (["figures", "--case", "9"], "case must be one of"),
        (["figures", "belt_oscillator"], "unknown model with figures 'belt_oscillator'; known: 'brake4dof'"),
    ],
)
def test_bad_input_is_one_line_and_status_2(capsys, tmp_path, monkeypatch, arguments, named):
    monkeypatch.chdir(tmp_path)
    status, text, complaint = run(capsys, *arguments)
    assert status == 2
    assert text == ""
    assert complaint.count("\n") == 1
    assert named in complaint


@pytest.mark.parametrize(
    ("content", "named"),
    [
        ("x = 1\n", "expected a module-level scene"),
        ("import fricmb as fm\n\nraise RuntimeError('broken')\n", "model.py:3: RuntimeError: broken"),
        ("def f(:\n", "model.py:1: SyntaxError"),
        (SCENE.replace("t_end", "end"), "--t-end is missing"),
        (SCENE.replace("2.0\n", "'long'\n"), "--t-end: expected a positive number; got 'long'"),
    ],
)
def test_bad_files_are_one_line_and_status_2(capsys, tmp_path, monkeypatch, content, named):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.py").write_text(content)
    status, _, complaint = run(capsys, "run", "model.py")
    assert status == 2
    assert complaint.count("\n") == 1
    assert named in complaint


RISING = """
import fricmb as fm

block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
belt = fm.Driven("belt", velocity={"x": 5.0})


from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class TurnsNegative(fm.FrictionLaw):
    mu_s: float

    def define_coefficient(self, r):
        return self.mu_s * (1 - r)


scene = fm.Scene("bad law", [
    block,
    fm.Force("push", block, axis="x", value=3.0),
    fm.Contact("sole", block, law=TurnsNegative(mu_s=1.0), normal_force=1.0),
])
t_end = 10.0
"""


def test_a_failed_run_keeps_its_files_and_ends_with_3(capsys, tmp_path):
    file = tmp_path / "rising.py"
    file.write_text(RISING.replace('velocity={"x": 1.0}', 'velocity={"x": 0.5}'))
    status, _, complaint = run(capsys, "run", file, "--no-plots", "--out", tmp_path / "out")
    assert status == 3
    assert complaint.splitlines()[-1].startswith("fricmb: ")
    assert "Traceback" not in complaint
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert 0 < summary["t_end"] < 10
    assert summary["failure"]["reason"]
    assert np.isfinite(fm.Solution.load(tmp_path / "out" / "solution.npz").q).all()


def test_every_part_is_listed_by_what_it_is_for():
    from fricmb.cli._show import PURPOSES

    listed = [name for names in PURPOSES.values() for name in names]
    places = (("", fm), ("space.", fm.space))
    public = {(prefix + name): getattr(home, name) for prefix, home in places for name in home.__all__}
    bases = (fm.Element, fm.Joint)
    parts = {name for name, kind in public.items() if isinstance(kind, type) and issubclass(kind, Part)}
    assert sorted(listed) == sorted(parts - {kind.__name__ for kind in bases})


def test_list_equations_plan(capsys):
    status, text, _ = run(capsys, "list")
    assert status == 0
    ends = "stops, play, and the law of impact: Stop, Backlash"
    for name in ("brake4dof", "stick_slip_chain", "Coulomb", "bdf", ends):
        assert name in text
    status, text, _ = run(capsys, "list", "parts")
    assert status == 0
    assert "friction\n    Contact\n        Friction between two ends" in text
    status, text, _ = run(capsys, "equations", "belt_oscillator", "--latex")
    assert status == 0
    assert "\\" in text
    assert "mass" in text
    status, text, _ = run(capsys, "equations", "belt_oscillator")
    assert status == 0
    assert "mass" in text
    status, text, _ = run(capsys, "plan", "brake4dof")
    assert status == 0
    assert "c1x" in text


@pytest.mark.parametrize("command", [[], ["run"], ["list"], ["equations"], ["plan"], ["bench"], ["figures"], ["plot"]])
def test_help_everywhere(capsys, command):
    status, text, _ = run(capsys, *command, "--help")
    assert status == 0
    assert "exit status" in text


def test_python_m_fricmb():
    done = subprocess.run([sys.executable, "-m", "fricmb", "--version"], capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stdout.startswith("fricmb ")


def test_import_is_light():
    """Neither numba, SymPy, scipy nor matplotlib before they are needed."""
    code = "import sys, fricmb; print([m for m in ('numba', 'sympy', 'scipy', 'matplotlib') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_figures(capsys, tmp_path):
    status, text, _ = run(capsys, "figures", "--case", "2", "--t-end", 10, "--rtol", "1e-6", "--out", tmp_path)
    assert status == 0
    assert (tmp_path / "brake4dof-case2.png").read_bytes()[:4] == b"\x89PNG"
    assert "brake4dof-case2.png" in text


@pytest.mark.slow
def test_figures_of_the_source(capsys, tmp_path):
    status, said, _ = run(capsys, "figures", "brake4dof", "--case", "1", "--out", tmp_path)
    assert status == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "brake4dof-case1.png",
        "figure02.png",
        "figure03.png",
        "findings.txt",
    ]
    findings = (tmp_path / "findings.txt").read_text()
    assert "[agrees] the rotor is braked almost linearly" in findings
    assert "[DIFFERS] slip goes on first" in findings
    verdicts = [line for line in findings.splitlines() if line.startswith("  [")]
    assert [line for line in said.splitlines() if line.startswith("  [")] == verdicts


@pytest.mark.parametrize("arguments", [[], ["run"], ["runn", "x"], ["run", "m", "--t-end", "abc"], ["list", "-x"]])
def test_a_wrong_option_is_one_line(capsys, arguments):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_pictures_of_an_earlier_run_go(capsys, tmp_path):
    (tmp_path / "phase.png").touch()
    run(capsys, "run", "puck_on_belt", "--no-plots", "--out", tmp_path)
    assert not list(tmp_path.glob("*.png"))


OWN_LAW = """
from dataclasses import dataclass
import fricmb as fm

@dataclass(frozen=True, kw_only=True)
class Mine(fm.FrictionLaw):
    mu: float

    def define_coefficient(self, r):
        return self.mu / (1 + r)

block = fm.Body("block", mass=2.0, velocity={"x": 1.0})
scene = fm.Scene("own", [block, fm.Contact("sole", block, law=Mine(mu=0.5), normal_force=4.0)])
t_end = 0.5
"""


def test_plot_runs_a_file_of_laws_when_it_is_told_to(capsys, tmp_path, monkeypatch):
    file = tmp_path / "own_scene.py"
    file.write_text(OWN_LAW)
    assert run(capsys, "run", file, "--no-plots", "--out", tmp_path)[0] == 0
    monkeypatch.delitem(sys.modules, "fricmb_scene_own_scene")
    status, _, complaint = run(capsys, "plot", tmp_path / "solution.npz", "force", "--of", "sole")
    assert status == 2
    assert "Mine" in complaint
    assert "return self.mu / (1 + r)" in complaint
    status, _, complaint = run(capsys, "plot", tmp_path / "solution.npz", "force", "--of", "sole", "--laws", file)
    assert (status, complaint) == (0, "")


def test_plot_of_a_damaged_file_is_bad_input(capsys, tmp_path):
    path = tmp_path / "solution.npz"
    path.write_bytes(b"PK\x03\x04 and nothing else")
    status, _, complaint = run(capsys, "plot", path, "energy")
    assert status == 2
    assert complaint.count("\n") == 1
    assert str(path) in complaint


def test_run_audits(tmp_path, capsys):
    code = main(["run", "belt_oscillator", "--t-end", "20", "--audit", "--no-plots", "--out", str(tmp_path)])
    assert code == 0
    assert "audit passes" in capsys.readouterr().out
    held = json.loads((tmp_path / "summary.json").read_text())["audit"]
    assert held["ok"]
    assert {"equations of motion", "energy"} <= {check["name"] for check in held["checks"]}
