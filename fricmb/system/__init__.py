"""A scene as arrays: what an integrator sees, and what its results mean in the scene's names and energies."""

from fricmb.system._build import build
from fricmb.system._mechanism_system import MechanismSystem
from fricmb.system._motions import DrivenMotion, driven_motions
from fricmb.system._system import System

__all__ = ["DrivenMotion", "MechanismSystem", "System", "build", "driven_motions"]
