"""Friction laws: the map from slip velocity, normal force and internal state to the friction force.

Each law is loaded when it is first used.
"""

from typing import Any

import lazy_loader

from fricmb.laws._published import published as published

_load, _, _names = lazy_loader.attach_stub(__name__, __file__)

#: Names of the laws of the catalogue.
names = (
    "Ambrosio", "ArctanRegularised", "BengisuAkay", "BlimanSorine", "BoucWen", "Bristle", "BrownMcPhee", "Contensou",
    "ContensouPade", "Coulomb", "CoulombViscous", "Cubic", "Dahl", "ElastoPlastic", "Elliptic", "FlashHeating",
    "GeneralisedMaxwellSlip", "Gonthier", "HyperbolicStribeck", "Iwan", "Jenkins", "Karnopp", "Leuven",
    "LinearRegularised", "LoadDependent", "Logarithmic", "Lorentzian", "LuGre", "Makkar", "Offset", "RateAndState",
    "Regularised", "SquareRootRegularised", "Stribeck", "Tabulated", "TanhRegularised", "Threlfall",
)  # fmt: skip

__all__ = [*_names, "names", "published"]


def __getattr__(name: str) -> Any:
    try:
        return _load(name)
    except AttributeError:
        if name.startswith("_") or name in _names:
            raise
        from fricmb.errors import no_attribute

        raise no_attribute(__name__, name, __all__) from None


def __dir__() -> list[str]:
    return sorted(__all__)
