"""What stands in brackets on an axis."""

from fricmb.values import DIMENSIONS, Units

#: Labels for a scene whose units are not known.
SCENE_UNITS = DIMENSIONS

__all__ = ["SCENE_UNITS", "Units"]
