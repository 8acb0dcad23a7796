"""Laws with internal states: bristles, sliders, hysteresis, the age of a contact."""

from fricmb.laws.bristle._bliman_sorine import BlimanSorine
from fricmb.laws.bristle._bouc_wen import BoucWen
from fricmb.laws.bristle._bristle import Bristle
from fricmb.laws.bristle._dahl import Dahl
from fricmb.laws.bristle._elasto_plastic import ElastoPlastic
from fricmb.laws.bristle._gms import GeneralisedMaxwellSlip
from fricmb.laws.bristle._gonthier import Gonthier
from fricmb.laws.bristle._iwan import Iwan
from fricmb.laws.bristle._jenkins import Jenkins
from fricmb.laws.bristle._leuven import Leuven
from fricmb.laws.bristle._lugre import LuGre
from fricmb.laws.bristle._rate_and_state import RateAndState

__all__ = [
    "BlimanSorine",
    "BoucWen",
    "Bristle",
    "Dahl",
    "ElastoPlastic",
    "GeneralisedMaxwellSlip",
    "Gonthier",
    "Iwan",
    "Jenkins",
    "Leuven",
    "LuGre",
    "RateAndState",
]
