"""Measured series as functions of time: wherever an expression in ``fm.t`` may stand."""

from fricmb.signal._signal import Signal, is_series, signal_of, slope_told

__all__ = ["Signal", "is_series", "signal_of", "slope_told"]
