"""The equations of a scene evaluated in numpy at the times of a run, on a path that shares nothing with the kernels."""

from fricmb.field._signals import element_axes, from_scene

__all__ = ["element_axes", "from_scene"]
