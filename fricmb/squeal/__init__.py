"""Squeal studies: where steady sliding is unstable, what feeds it, how it grows, where it ends, how sure that is."""

from fricmb.squeal._derivatives import Derivatives
from fricmb.squeal._feed import Feed
from fricmb.squeal._growth import Growth
from fricmb.squeal._saturation import Saturation
from fricmb.squeal._screening import Screening
from fricmb.squeal._study import Study, study
from fricmb.squeal._thresholds import Threshold
from fricmb.squeal._uncertain import Uncertainty

__all__ = ["Derivatives", "Feed", "Growth", "Saturation", "Screening", "Study", "Threshold", "Uncertainty", "study"]
