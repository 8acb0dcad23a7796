"""Pictures of scenes with bodies in space."""

from fricmb.plot.space._make import space_sketch_of_run, space_sketch_of_scene
from fricmb.plot.space._page import space_data
from fricmb.plot.space._picture import draw_in_space, space_drawing_of_run
from fricmb.plot.space._sketch import SpaceSketch

__all__ = [
    "SpaceSketch",
    "draw_in_space",
    "space_data",
    "space_drawing_of_run",
    "space_sketch_of_run",
    "space_sketch_of_scene",
]
