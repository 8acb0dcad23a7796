"""Options of pictures that cannot be are named, with the value and what is accepted."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import fricmb as fm

WRONG = (
    None, -1.0, 0, "", "nothing", [], {}, np.nan, np.inf, 1j, np.zeros((2, 3)), np.array(1.0), object(), [None], b"x",
    10**400, [[1, 2], [3]], True, (1.0,), range(3), fm.t, fm.Body,
)  # fmt: skip


@pytest.fixture(scope="module")
def given(tmp_path_factory):
    """Pictures with right options, of which one at a time is made wrong."""
    folder = tmp_path_factory.mktemp("pictures")
    scene = fm.models.belt_oscillator(law=fm.laws.Stribeck(mu_s=1.0, mu_k=0.5, v_s=0.2))
    sol = fm.simulate(scene, t_end=10.0, rtol=1e-4)
    span = {"t_start": 1.0, "t_end": 3.0}
    one, both = "belt.velocity.x", ("belt.velocity.x", "mass.mass")
    analysis, plot = fm.analysis, sol.plot
    found = analysis.complex_eigenvalues(scene, over=one, values=[0.1, 0.2])
    table = analysis.stability_map(scene, over=both, values=[[0.1, 0.2], [1.0, 2.0]])
    return {
        "energy": (plot.energy, {**span, "ax": None}),
        "force": (plot.force, {"contact": "sole", **span, "ax": None}),
        "orders": (plot.orders, {"name": "mass.x", "contact": "sole", "highest": 5.0, "hz": False, "ax": None}),
        "path": (plot.path, {"x": "mass.x", "y": "belt.x", **span, "ax": None}),
        "phase": (plot.phase, {"name": "mass.x", **span, "ax": None}),
        "spectrogram": (plot.spectrogram, {"name": "mass.x", "highest": 5.0, "segment": None, "hz": False, "ax": None}),
        "spectrum": (plot.spectrum, {"name": "mass.x", "highest": 5.0, "hz": False, "ax": None}),
        "transitions": (plot.transitions, {**span, "ax": None}),
        "velocities": (plot.velocities, {"names": ["mass.x"], "zoom": None, **span, "ax": None}),
        "sound": (plot.sound, {"name": "mass.x", "path": folder / "a.wav", "seconds": 0.1, "speed": 1.0, **span}),
        "view": (plot.view, {"path": folder / "a.html", **span}),
        "animation": (plot.animation, {"path": None, "frames": 2, "fps": 25.0, "magnify": None, **span}),
        "law": (fm.plot.law, {"law": scene["sole"].law, "normal_force": 1.0, "ax": None}),
        "eigenvalues": (fm.plot.eigenvalues, {"found": found, "hz": False, "modes": [0], "units": None}),
        "stability": (fm.plot.stability, {"found": table, "ax": None, "units": None}),
        "draw": (scene.draw, {"ax": None}),
    }


NAMES = (
    "energy", "force", "orders", "path", "phase", "spectrogram", "spectrum", "transitions", "velocities", "sound",
    "view", "animation", "law", "eigenvalues", "stability", "draw",
)  # fmt: skip


@pytest.mark.filterwarnings("error:Warning", "ignore::fricmb.analysis.AliasingWarning", "ignore:Animation was deleted")
@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_option_is_an_error_of_our_own(given, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # some words are paths of files
    function, right = given[name]
    said = []
    for argument in right:
        for wrong in WRONG:
            try:
                function(**{**right, argument: wrong})
            except fm.FricmbError as error:
                said.append(str(error))
            finally:
                plt.close("all")
    assert len(said) > 10
    assert [text for text in said if "\n" in text or len(text) > 400] == []


@pytest.mark.parametrize(("name", "option", "text"), [
    ("energy", {"ax": 3}, "energy: ax must be axes of matplotlib or None; got 3"),
    ("phase", {"name": None}, "phase: name must be a name; got None"),
    ("spectrum", {"hz": np.ones(2)}, r"spectrum: hz must be True or False; got array\(\[1., 1.\]\)"),
    ("spectrum", {"highest": -1.0}, "spectrum: highest must be a finite number > 0 or None; got -1.0"),
    ("velocities", {"zoom": ()}, r"velocities: zoom must be True, False or two times, \(1.0, 2.0\) or None; got \(\)"),
    ("animation", {"frames": 0}, "animation: frames must be an integer of at least 1 or None; got 0"),
    ("sound", {"speed": 0.0}, "sound: speed must be a finite number > 0; got 0.0"),
    ("law", {"law": 3}, "law: law must be a friction law, such as"),
    ("eigenvalues", {"modes": [5]}, r"eigenvalues: modes must be a list of numbers of modes, 0 to 0; got \[5\]"),
    ("stability", {"found": 3}, "stability: found must be what stability_map returns; got 3"),
])  # fmt: skip
def test_what_a_picture_cannot_take_is_named(given, name, option, text):
    function, right = given[name]
    with pytest.raises(fm.analysis.AnalysisError, match=text):
        function(**{**right, **option})


@pytest.mark.parametrize(("name", "suffix"), [("sound", "wav"), ("view", "html"), ("animation", "html")])
def test_a_file_that_cannot_be_written_is_named(given, name, suffix, tmp_path):
    function, right = given[name]
    with pytest.raises(fm.FricmbError, match=r"path: '.*nowhere.*' cannot be written: No such file or directory"):
        function(**{**right, "path": tmp_path / "nowhere" / f"a.{suffix}"})


def test_names_may_come_one_by_one(given):
    function, right = given["velocities"]
    figure = function(**{**right, "names": (name for name in ("mass.x", "belt.x"))})
    assert len(figure.axes[0].lines) == 2


@pytest.mark.parametrize("picture", [lambda plot: plot.transitions(), lambda plot: plot.orders("m.x")])
def test_pictures_of_contacts_need_one(picture):
    body = fm.Body("m", mass=1.0, velocity={"x": 1.0})
    sol = fm.simulate(fm.Scene("free", [body, fm.Spring("k", body, axis="x", stiffness=1.0)]), t_end=20.0)
    with pytest.raises(fm.SceneError, match="expected a run with contacts; this one has none"):
        picture(sol.plot)
