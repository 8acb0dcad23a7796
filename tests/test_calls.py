"""A call with an unknown, a missing or an unnamed argument says which was meant."""

import copy
import inspect
import pickle

import pytest

import fricmb as fm
from fricmb._calls import answers
from fricmb.errors import CallError


@pytest.fixture(scope="module")
def block():
    return fm.Body("block", mass=1.0)


def said(call):
    with pytest.raises(CallError) as caught:
        call()
    error = caught.value
    assert isinstance(error, fm.SceneError)
    assert isinstance(error, TypeError)
    return str(error)


def test_unknown_names(block):
    sol = fm.simulate(fm.models.belt_oscillator(), t_end=1.0)
    scene, law = sol.scene, fm.laws.Coulomb(mu_s=0.5)
    calls = {
        "Spring(): unknown argument 'stifness'; did you mean stiffness=?":
            lambda: fm.Spring("k", block, axis="x", stifness=1.0),
        "Coulomb(): unknown argument 'mu'; did you mean mu_s= or mu_k=?": lambda: fm.laws.Coulomb(mu=0.5),
        "Revolute(): unknown argument 'radus'; did you mean radius=?": lambda: fm.Revolute("pin", block, radus=1.0),
        "Spring(): unknown argument 'stifness'; did you mean stiffness=? ":
            lambda: fm.normal.Spring(axis="y", stifness=1.0),
        "belt_oscillator(): unknown argument 'mu'; did you mean mu_s= or mu_k=?":
            lambda: fm.models.belt_oscillator(mu=1.0),
        "simulate(): unknown argument 'rtl'; did you mean rtol=": lambda: fm.simulate(scene, t_end=1.0, rtl=1e-6),
        "poincare_section(): unknown argument 'risng'; did you mean rising=?":
            lambda: fm.analysis.poincare_section(sol, period=1.0, risng=True),
        "SolutionPlots.velocities(): unknown argument 'tstart'; did you mean t_start=?":
            lambda: sol.plot.velocities(tstart=1.0),
        "FrictionLaw.force(): unknown argument 'vrel'; did you mean v_rel=?": lambda: law.force(vrel=1.0),
        "Scene(): unknown argument 'unit'; did you mean units=?": lambda: fm.Scene("s", [block], unit=fm.Units()),
        "ModalBody(): unknown argument 'frequencies_hz'; did you mean frequencies=? Frequencies are angular: 50 Hz are":
            lambda: fm.ModalBody("m", frequencies_hz=[1.0], damping_ratios=0.0, shapes={}),
    }  # fmt: skip
    for message, call in calls.items():
        assert message.strip() in said(call)


def test_unnamed_and_missing_ones(block):
    scene = fm.models.belt_oscillator()
    assert said(lambda: fm.simulate(scene, 50)) == (
        "simulate(): takes 1 argument without a name (scene), got 2; write t_end=50"
    )
    assert said(lambda: fm.Body("b", 1.0)).endswith("(name), got 2; write mass=1.0")
    law = fm.laws.Coulomb(mu_s=0.5)
    assert said(lambda: fm.Contact("sole", block, law=law)).startswith("Contact(): needs normal_force= as well; ")
    assert said(fm.Spring).startswith("Spring(): needs name=, a=, axis= and stiffness= as well; ")
    assert said(lambda: fm.Spring("k", block, name="k", axis="x", stiffness=1.0)) == (
        "Spring(): got name twice, as argument 1 and by name"
    )


def test_every_declaration_and_law_answers():
    kinds = [getattr(fm, name) for name in fm.__all__ if isinstance(getattr(fm, name, None), type)]
    kinds += [getattr(fm.laws, name) for name in fm.laws.names] + [
        getattr(fm.space, name) for name in fm.space.__all__ if isinstance(getattr(fm.space, name), type)
    ]
    declared = [kind for kind in kinds if hasattr(kind, "_refuse") and not inspect.isabstract(kind)]
    assert len(declared) > 60
    for kind in declared:
        assert "unknown argument 'nonsense'" in said(lambda kind=kind: kind(nonsense=1))


def test_every_model_and_function_answers():
    models = [model.build for model in fm.models.catalogue.values()]
    functions = [getattr(fm.analysis, name) for name in fm.analysis.__all__]
    functions += [getattr(fm, name) for name in ("simulate", "sweep", "fit", "solve_dae", "parameter", "coordinate")]
    for function in [*models, *(f for f in functions if inspect.isfunction(f))]:
        open_ended = any(p.kind is p.VAR_KEYWORD for p in inspect.signature(function).parameters.values())
        if not open_ended:
            assert "unknown argument 'nonsense'" in said(lambda function=function: function(nonsense=1))


def test_errors_from_inside_stay_as_they_are():
    @answers
    def inner(number, *, other=1):
        return number + "text"

    with pytest.raises(TypeError, match="unsupported operand") as caught:
        inner(1)
    assert not isinstance(caught.value, CallError)


def test_declarations_are_what_they_were(block):
    spring = fm.Spring("k", block, axis="x", stiffness=1.0)
    assert pickle.loads(pickle.dumps(spring)) == spring
    assert copy.copy(spring) == spring
    assert list(inspect.signature(fm.Spring).parameters)[:4] == ["name", "a", "b", "axis"]
    assert list(inspect.signature(fm.laws.Coulomb).parameters) == ["mu_s", "mu_k", "insist"]
