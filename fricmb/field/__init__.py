"""The equations of a scene evaluated in numpy at the times of a run, on a path that shares nothing with the kernels."""

from fricmb.field._asked import AskedEvent, Seen
from fricmb.field._sign_changes import sign_changes
from fricmb.field._signals import element_axes, from_scene
from fricmb.field._touches import Touches, touches

__all__ = ["AskedEvent", "Seen", "Touches", "element_axes", "from_scene", "sign_changes", "touches"]
