"""Built-in scenes, one file each: source, units and parameters in the docstring of each function.

:data:`catalogue` lists them with the duration of their standard run.
"""

if __name__ != "fricmb.models":
    raise ImportError(f"the folder 'models' is the package fricmb.models; it was imported as {__name__!r}")

from fricmb.models._catalogue import Model, catalogue
from fricmb.models.andrews import andrews
from fricmb.models.ball_in_cylinder import ball_in_cylinder
from fricmb.models.band_brake import band_brake
from fricmb.models.belt_drive import belt_drive
from fricmb.models.belt_oscillator import belt_oscillator
from fricmb.models.billiard import billiard
from fricmb.models.block_stack import block_stack
from fricmb.models.bouncing_ball import bouncing_ball
from fricmb.models.brake4dof import brake4dof
from fricmb.models.car_axis import car_axis
from fricmb.models.drive_train import drive_train
from fricmb.models.dropped_disc import dropped_disc
from fricmb.models.dry_ball_joint import dry_ball_joint
from fricmb.models.dry_pendulum import dry_pendulum
from fricmb.models.four_bar import four_bar
from fricmb.models.friction_oscillator import friction_oscillator
from fricmb.models.gear_rattle import gear_rattle
from fricmb.models.heavy_top import heavy_top
from fricmb.models.impact_damper import impact_damper
from fricmb.models.minimal_flutter import minimal_flutter
from fricmb.models.newtons_cradle import newtons_cradle
from fricmb.models.oscillating_table import oscillating_table
from fricmb.models.pad_lift_off import pad_lift_off
from fricmb.models.pad_rotor import pad_rotor
from fricmb.models.painleve_rod import painleve_rod
from fricmb.models.planar_oscillator import planar_oscillator
from fricmb.models.puck_on_belt import puck_on_belt
from fricmb.models.rising_top import rising_top
from fricmb.models.rocking_block import rocking_block
from fricmb.models.rolling_coin import rolling_coin
from fricmb.models.rotor_doublet import rotor_doublet
from fricmb.models.slider_crank import slider_crank
from fricmb.models.sprag_slip import sprag_slip
from fricmb.models.stick_slip_chain import stick_slip_chain
from fricmb.models.turntable import turntable
from fricmb.models.vibrating_incline import vibrating_incline
from fricmb.models.wheel_on_slope import wheel_on_slope
from fricmb.models.wheelset import wheelset
from fricmb.models.wobbling_disc_brake import wobbling_disc_brake
from fricmb.models.woodpecker import woodpecker

__all__ = [
    "Model",
    "andrews",
    "ball_in_cylinder",
    "band_brake",
    "belt_drive",
    "belt_oscillator",
    "billiard",
    "block_stack",
    "bouncing_ball",
    "brake4dof",
    "car_axis",
    "catalogue",
    "drive_train",
    "dropped_disc",
    "dry_ball_joint",
    "dry_pendulum",
    "four_bar",
    "friction_oscillator",
    "gear_rattle",
    "heavy_top",
    "impact_damper",
    "minimal_flutter",
    "newtons_cradle",
    "oscillating_table",
    "pad_lift_off",
    "pad_rotor",
    "painleve_rod",
    "planar_oscillator",
    "puck_on_belt",
    "rising_top",
    "rocking_block",
    "rolling_coin",
    "rotor_doublet",
    "slider_crank",
    "sprag_slip",
    "stick_slip_chain",
    "turntable",
    "vibrating_incline",
    "wheel_on_slope",
    "wheelset",
    "wobbling_disc_brake",
    "woodpecker",
]
