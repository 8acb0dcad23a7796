"""Normal-force laws of contacts: the force that presses two bodies together, as a function of their approach."""

from fricmb.normal._base import NormalLaw
from fricmb.normal._given import Constant, Prescribed
from fricmb.normal._hertz import Hertz
from fricmb.normal._spring import Spring

#: Laws of the approach; Constant and Prescribed stand for a number and an expression.
names = ("Hertz", "Spring")

__all__ = ["Constant", "Hertz", "NormalLaw", "Prescribed", "Spring", "names"]
