"""Built-in scenes, one file each: source, units and parameters in the docstring of each function.

:data:`catalogue` lists them with the duration of their standard run.
"""

if __name__ != "fricmb.models":
    raise ImportError(f"the folder 'models' is the package fricmb.models; it was imported as {__name__!r}")

from fricmb.models._catalogue import Model, catalogue
from fricmb.models.belt_oscillator import belt_oscillator
from fricmb.models.block_stack import block_stack
from fricmb.models.brake4dof import brake4dof
from fricmb.models.friction_oscillator import friction_oscillator
from fricmb.models.minimal_flutter import minimal_flutter
from fricmb.models.pad_rotor import pad_rotor
from fricmb.models.planar_oscillator import planar_oscillator
from fricmb.models.puck_on_belt import puck_on_belt
from fricmb.models.rotor_doublet import rotor_doublet
from fricmb.models.stick_slip_chain import stick_slip_chain

__all__ = [
    "Model",
    "belt_oscillator",
    "block_stack",
    "brake4dof",
    "catalogue",
    "friction_oscillator",
    "minimal_flutter",
    "pad_rotor",
    "planar_oscillator",
    "puck_on_belt",
    "rotor_doublet",
    "stick_slip_chain",
]
