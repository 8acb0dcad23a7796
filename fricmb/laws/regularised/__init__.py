"""Regularised laws: a steep curve in place of the jump at zero velocity."""

from fricmb.laws.regularised._ambrosio import Ambrosio
from fricmb.laws.regularised._arctan import ArctanRegularised
from fricmb.laws.regularised._base import RegularisedLaw
from fricmb.laws.regularised._bengisu_akay import BengisuAkay
from fricmb.laws.regularised._brown_mcphee import BrownMcPhee
from fricmb.laws.regularised._karnopp import Karnopp
from fricmb.laws.regularised._linear import LinearRegularised
from fricmb.laws.regularised._makkar import Makkar
from fricmb.laws.regularised._regularised import Regularised
from fricmb.laws.regularised._square_root import SquareRootRegularised
from fricmb.laws.regularised._tanh import TanhRegularised
from fricmb.laws.regularised._threlfall import Threlfall

__all__ = [
    "Ambrosio",
    "ArctanRegularised",
    "BengisuAkay",
    "BrownMcPhee",
    "Karnopp",
    "LinearRegularised",
    "Makkar",
    "Regularised",
    "RegularisedLaw",
    "SquareRootRegularised",
    "TanhRegularised",
    "Threlfall",
]
