"""The list of built-in models: what a program that offers them all needs to know."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import fricmb as fm
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
from fricmb.values import DIMENSIONLESS, SI, Units


@dataclass(frozen=True, kw_only=True)
class Model:
    """A built-in model.

    Attributes
    ----------
    build : callable
        Makes the scene; its keyword arguments are the model's arguments.
    t_end : float
        Duration of the standard run, in the model's unit of time.
    units : Units
        Of the default arguments, for the labels of pictures.
    """

    build: Callable[..., fm.Scene]
    t_end: float
    units: Units = DIMENSIONLESS

    @property
    def name(self) -> str:
        """Name under which the model is known."""
        return self.build.__name__

    @property
    def summary(self) -> str:
        """First line of the model's description."""
        return (inspect.getdoc(self.build) or "").partition("\n")[0]


_MODELS = (
    Model(build=brake4dof, t_end=700.0),
    Model(build=belt_oscillator, t_end=200.0),
    Model(build=friction_oscillator, t_end=20.0),
    Model(build=planar_oscillator, t_end=40.0),
    Model(build=puck_on_belt, t_end=1.0, units=SI),
    Model(build=block_stack, t_end=1.0, units=SI),
    Model(build=stick_slip_chain, t_end=60.0),
    Model(build=minimal_flutter, t_end=60.0),
    Model(build=rotor_doublet, t_end=100.0),
    Model(build=pad_rotor, t_end=0.04, units=SI),
    Model(build=dry_pendulum, t_end=12.0, units=SI),
    Model(build=andrews, t_end=0.03, units=SI),
    Model(build=car_axis, t_end=3.0),
    Model(build=sprag_slip, t_end=1.0, units=SI),
    Model(build=band_brake, t_end=1.2, units=SI),
    Model(build=belt_drive, t_end=3.5, units=SI),
    Model(build=wheel_on_slope, t_end=2.0, units=SI),
    Model(build=slider_crank, t_end=1.0, units=SI),
    Model(build=painleve_rod, t_end=0.2, units=SI),
    Model(build=four_bar, t_end=2.0, units=SI),
    Model(build=drive_train, t_end=20.0, units=SI),
    Model(build=bouncing_ball, t_end=3.0, units=SI),
    Model(build=rocking_block, t_end=4.0, units=SI),
    Model(build=gear_rattle, t_end=0.2, units=SI),
    Model(build=oscillating_table, t_end=2.0, units=SI),
    Model(build=impact_damper, t_end=10.0, units=SI),
    Model(build=newtons_cradle, t_end=3.0, units=SI),
    Model(build=woodpecker, t_end=0.75, units=SI),
    Model(build=vibrating_incline, t_end=0.5, units=SI),
    Model(build=dropped_disc, t_end=2.5, units=SI),
    Model(build=pad_lift_off, t_end=0.1, units=SI),
    Model(build=heavy_top, t_end=1.0, units=SI),
    Model(build=rising_top, t_end=6.0, units=SI),
    Model(build=billiard, t_end=1.0, units=SI),
    Model(build=rolling_coin, t_end=2.0, units=SI),
    Model(build=turntable, t_end=3.0, units=SI),
    Model(build=ball_in_cylinder, t_end=2.0, units=SI),
    Model(build=dry_ball_joint, t_end=6.0, units=SI),
    Model(build=wheelset, t_end=2.0, units=SI),
    Model(build=wobbling_disc_brake, t_end=0.02, units=SI),
)

#: The built-in models by name.
catalogue = MappingProxyType({model.name: model for model in _MODELS})
