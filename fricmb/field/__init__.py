"""The equations of a scene evaluated in numpy at the times of a run, on a path that shares nothing with the kernels."""

from fricmb.field._signals import element_axes, from_scene
from fricmb.field._touches import Touches, touches

__all__ = ["Touches", "element_axes", "from_scene", "touches"]
