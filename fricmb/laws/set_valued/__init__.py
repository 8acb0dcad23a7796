"""Set-valued laws: stick inside the cone, slip with a coefficient."""

from fricmb.laws.set_valued._coulomb import Coulomb
from fricmb.laws.set_valued._coulomb_viscous import CoulombViscous
from fricmb.laws.set_valued._cubic import Cubic
from fricmb.laws.set_valued._flash_heating import FlashHeating
from fricmb.laws.set_valued._hyperbolic import HyperbolicStribeck
from fricmb.laws.set_valued._load_dependent import LoadDependent
from fricmb.laws.set_valued._logarithmic import Logarithmic
from fricmb.laws.set_valued._lorentzian import Lorentzian
from fricmb.laws.set_valued._stribeck import Stribeck
from fricmb.laws.set_valued._tabulated import Tabulated

__all__ = [
    "Coulomb",
    "CoulombViscous",
    "Cubic",
    "FlashHeating",
    "HyperbolicStribeck",
    "LoadDependent",
    "Logarithmic",
    "Lorentzian",
    "Stribeck",
    "Tabulated",
]
