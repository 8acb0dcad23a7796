"""A wrong argument of a public function is named, with its value, in one line of an error of fricmb's own."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.analysis import AnalysisError
from fricmb.errors import ArgumentError, UnknownNameError

WRONG = (None, -1.0, "x", [], {}, np.nan, 1j, np.zeros((2, 3)), object(), [None], {"x": 1}, 10**400)
analysis = fm.analysis


def driven_scene():
    omega, mass = fm.parameter("omega", 1.0), fm.Body("mass", mass=1.0)
    load = fm.Force("load", mass, axis="x", value=0.5 * sympy.cos(omega * fm.t))
    spring, damper = fm.Spring("spring", mass, axis="x", stiffness=1.0), fm.Damper("c", mass, axis="x", damping=0.2)
    return fm.Scene("driven", [mass, load, spring, damper])


@pytest.fixture(scope="module")
def given():
    """Right arguments of every function, of which one at a time is made wrong."""
    scene = fm.models.belt_oscillator()
    sol = fm.simulate(scene, t_end=30.0, rtol=1e-5)
    x = np.sin(0.1 * np.arange(200)) + 0.1 * np.random.default_rng(0).normal(size=200)
    lugre, coulomb = fm.laws.LuGre.example(), fm.laws.Coulomb.example()
    cycle = analysis.limit_cycle(scene, start=sol, rtol=1e-8)
    running = analysis.spectrogram(x, 0.1)
    speed, belt = np.ones(running.t.size), "belt.velocity.x"
    bounds, data = {"sole.law.mu_k": (0.5, 1.2)}, {"t": [1.0, 2.0], "mass.x": [0.1, 0.2]}
    section = ("mass.x.velocity", 0.0)
    diagram = {"t_end": 5.0, "signal": "mass.x", "section": section, "progress": False, "workers": 1}
    regimes = {"v_reg": 1e-3, "stiffness": 1e3, "t_end": 1.0, "points": 50}
    maps = {"over": ("belt.velocity.x", "mass.mass"), "values": [[0.1], [1.0]]}
    still = {"t": np.linspace(0.0, 1.0, 5), "velocity": np.zeros_like}
    exponents = {"scene": scene, "t_end": 5.0, "intervals": 2, "progress": False}
    return {
        "limit_cycle": (analysis.limit_cycle, {"scene": scene, "start": sol, "rtol": 1e-8}),
        "lyapunov": (analysis.lyapunov, {**exponents, "discard": 0.1}),
        "continue_cycle": (analysis.continue_cycle, {"cycle": cycle, "over": belt, "to": 0.11, "points": 2}),
        "poincare_section": (analysis.poincare_section, {"sol": sol, "section": section, "discard": 0.5}),
        "poincare_section by time": (analysis.poincare_section, {"sol": sol, "period": 1.0}),
        "bifurcation_diagram": (
            analysis.bifurcation_diagram, {"scene": scene, "over": "belt.velocity.x", "values": [0.1], **diagram}
        ),
        "frequency_response": (analysis.frequency_response, {
            "scene": driven_scene(), "over": "omega", "values": [1.0], "measure": "mass.x", "periods": 6,
            "progress": False,
        }),
        "steady_sliding": (analysis.steady_sliding, {"scene": scene}),
        "complex_eigenvalues": (
            analysis.complex_eigenvalues, {"scene": scene, "over": "belt.velocity.x", "values": [0.1, 0.2]}
        ),
        "stability_map": (analysis.stability_map, {"scene": scene, **maps}),
        "energy_ledger": (analysis.energy_ledger, {"sol": sol}),
        "modal_energy": (analysis.modal_energy, {"sol": sol}),
        "compare_regimes": (analysis.compare_regimes, {"scene": scene, "contact": "sole", **regimes}),
        "path": (analysis.path, {"law": lugre, **still}),
        "pull": (analysis.pull, {"law": lugre, "speed": 1e-4, "points": 10, "normal_force": 1.0}),
        "cycle": (analysis.cycle, {"law": coulomb, "amplitude": 1.0, "period": 1.0, "cycles": 1, "points": 8}),
        "settling_distance": (analysis.settling_distance, {"law": lugre, "normal_force": 1.0}),
        "compiled_force": (analysis.compiled_force, {"law": lugre, "d": 1}),
        "uniform": (analysis.uniform, {"sol": sol, "name": "mass.x", "dt": 0.05}),
        "maximum_entropy_spectrum": (analysis.maximum_entropy_spectrum, {"x": x, "dt": 0.1, "order": 4}),
        "welch_spectrum": (analysis.welch_spectrum, {"x": x, "dt": 0.1, "overlap": 0.5, "window": "hann"}),
        "spectrogram": (analysis.spectrogram, {"x": x, "dt": 0.1, "t_start": 0.0}),
        "spectral_peaks": (analysis.spectral_peaks, {"x": x, "dt": 0.1, "prominence": 3.0, "parts": 3}),
        "order_map": (analysis.order_map, {"running": running, "speed": speed, "order": [0.1]}),
        "sliding_speed": (analysis.sliding_speed, {"sol": sol, "contact": "sole", "t": [1.0]}),
        "coefficient": (coulomb.coefficient, {"r": 0.1, "normal_force": 1.0}),
        "force": (lugre.force, {"v_rel": 0.1, "normal_force": 1.0, "state": [0.0]}),
        "rate": (lugre.rate, {"v_rel": 0.1, "normal_force": 1.0, "state": [0.0]}),
        "sweep": (fm.sweep, {"scene": scene, "runs": [{}], "t_end": 1.0, "progress": False}),
        "fit": (fm.fit, {"scene": scene, "data": data, "parameters": bounds, "starts": 1, "progress": False}),
        "solve_dae": (
            fm.solve_dae,
            {"fun": lambda t, y, yp: yp + y, "t_span": (0.0, 1.0), "y0": [1.0], "max_step": 1.0, "bandwidth": (0, 0)},
        ),
    }  # fmt: skip


NAMES = (
    "limit_cycle", "lyapunov", "continue_cycle", "poincare_section", "poincare_section by time", "bifurcation_diagram",
    "frequency_response", "steady_sliding", "complex_eigenvalues", "stability_map", "energy_ledger", "modal_energy",
    "compare_regimes",
    "path", "pull", "cycle", "settling_distance", "compiled_force", "uniform", "maximum_entropy_spectrum",
    "welch_spectrum", "spectrogram", "spectral_peaks", "order_map", "sliding_speed", "coefficient", "force", "rate",
    "sweep", "fit", "solve_dae",
)  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_argument_is_an_error_of_our_own(given, name):
    function, right = given[name]
    said = []
    for argument in sorted({*right} - {"progress", "workers"}):
        for wrong in WRONG:
            try:
                function(**{**right, argument: wrong})
            except fm.FricmbError as error:
                said.append(str(error))
    assert said
    assert [text for text in said if "\n" in text] == []


def test_every_function_of_the_analysis_is_asked(given):
    public = {name: getattr(analysis, name) for name in analysis.__all__}
    functions = {name for name, held in public.items() if callable(held) and not isinstance(held, type)}
    assert functions <= set(NAMES) == set(given)


@pytest.mark.parametrize(("name", "argument", "wrong", "text"), [
    ("limit_cycle", "scene", 3, "limit_cycle: scene must be a Scene; got 3"),
    ("lyapunov", "scene", None, "lyapunov: scene must be a Scene; got None"),
    ("lyapunov", "start", 3, "lyapunov: start must be a Solution; got 3"),
    ("maximum_entropy_spectrum", "x", 3, "x must be"),
    ("maximum_entropy_spectrum", "x", np.full(9, 1j), "x must be"),
    ("path", "t", [1.0, 0.0], r"path: t must be \(n,\) rising numbers"),
    ("poincare_section by time", "period", -1.0, "period must be positive; got -1"),
    ("stability_map", "over", "mass.mass", "over and values must be two each"),
])  # fmt: skip
def test_what_an_analysis_cannot_take_is_named(given, name, argument, wrong, text):
    function, right = given[name]
    with pytest.raises(AnalysisError, match=text):
        function(**{**right, argument: wrong})


@pytest.mark.parametrize("name", ["sweep", "fit", "limit_cycle", "lyapunov", "bifurcation_diagram", "compare_regimes"])
def test_a_misspelt_option_is_named_with_those_near(given, name):
    function, right = given[name]
    with pytest.raises(UnknownNameError, match=rf"unknown option of {name} 'metod'; did you mean 'method'"):
        function(**right, metod="bdf")


def test_an_argument_of_the_function_itself_is_suggested():
    with pytest.raises(UnknownNameError, match=r"unknown option of limit_cycle 'perod'; did you mean 'period'"):
        fm.analysis.limit_cycle(fm.models.belt_oscillator(), perod=1.0)


def test_solve_dae_names_what_it_cannot_take(given):
    function, right = given["solve_dae"]
    with pytest.raises(ArgumentError, match=r"All components of `rtol` must be finite, not nan"):
        function(**right, rtol=np.nan)
    assert issubclass(ArgumentError, ValueError)


def test_values_of_parameters_reach_the_cycle():
    """They were those of the runs alone: its derivatives and branches were of the scene as it was declared."""
    scene = fm.models.belt_oscillator()
    cycle = analysis.limit_cycle(scene, parameters={"belt.velocity.x": 0.2})
    assert cycle.scene.parameters["belt.velocity.x"] == 0.2


@pytest.mark.parametrize("field", ["mu_s", "mu_k", "v_s"])
@pytest.mark.parametrize("wrong", [None, (), (1.0, 2.0), True])
def test_a_field_of_a_law_is_one_number(field, wrong):
    right = {"sigma0": 1.0, "sigma1": 0.0, "sigma2": 0.0, "mu_s": 1.0, "mu_k": 0.5, "v_s": 0.1}
    if wrong == (1.0, 2.0) and field == "v_s":
        pytest.skip("nothing compares it with a number")
    with pytest.raises(fm.LawError, match=f"LuGre: {field} must be"):
        fm.laws.LuGre(**{**right, field: wrong})
