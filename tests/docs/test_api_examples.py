"""The reference's pages of public names: each has an example, which runs; formulas are those of the code."""

import re
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
sys.path.insert(0, str(DOCS))

import _api  # noqa: E402
import _examples  # noqa: E402


def named(page):
    text = (DOCS / "reference" / f"{page}.md").read_text(encoding="utf-8")
    return re.findall(r"^   ([\w.]+)$", text, re.MULTILINE)


NAMES = {prefix + name for page, prefix in (("api", ""), ("laws", ""), ("models", "models.")) for name in named(page)}
#: A description of a model, not one.
WITHOUT = {"models.Model"}
CODES = {code: name for name in sorted(NAMES, reverse=True) if (code := _examples.example(name))}
DRAWN = {
    "Revolute", "Prismatic", "Fixed", "Rod", "RollerOnLine", "RollerOnCircle", "Gear", "DrivenAngle", "DrivenSlide",
    "analysis.compare_regimes", "analysis.path", "analysis.maximum_entropy_spectrum", "analysis.energy_ledger",
    "analysis.complex_eigenvalues", "analysis.stability_map",
}  # fmt: skip


def test_every_public_name_has_an_example():
    assert sorted(name for name in NAMES - WITHOUT if _examples.example(name) is None) == []
    assert set(_examples.EXAMPLES) <= NAMES
    assert set(_examples.SHARED) <= NAMES


@pytest.mark.slow
@pytest.mark.parametrize("code", CODES, ids=CODES.get)
def test_the_example_runs(code, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    printed, figure = _api.run(code)
    assert printed.strip() or figure is not None
    assert not re.search(r"\bnan\b", printed)
    if code in {_examples.example(name) for name in DRAWN} or "law_figure" in code:
        assert figure is not None


def test_formulas_are_those_of_the_laws():
    import fricmb as fm

    stribeck = "\n".join(_api.formula(fm.laws.Stribeck))
    assert r"e^{- \left(\frac{r}{v_{s}}\right)^{\mathrm{exponent}}}" in stribeck
    dahl = "\n".join(_api.formula(fm.laws.Dahl))
    assert r"\dot {z} = v - \frac{\sigma_{0} \, z \, \left|{v}\right|}{\mu}" in dahl
    assert "10^{-200}" not in dahl
    typeset = [name for name in fm.laws.names if _api.formula(getattr(fm.laws, name))]
    assert len(typeset) >= 28


def test_internals_are_not_shown():
    members = ["numeric_slots", "only_numbers", "with_slots", "coefficient", "dof_names"]
    assert _api.shown("fricmb", "Body", members) == ["dof_names"]
    assert _api.shown("fricmb.laws", "Jenkins", members) == []
    assert _api.shown("fricmb", "FrictionLaw", members) == ["coefficient"]
