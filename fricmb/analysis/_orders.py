"""Order tracking: spectra against the sliding speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fricmb._calls import answers
from fricmb.analysis._errors import AnalysisError, Floats, checked_kind, checked_numbers, checked_solution
from fricmb.analysis._welch import Spectrogram

if TYPE_CHECKING:
    from fricmb.solution import Solution


@dataclass(frozen=True, kw_only=True)
class OrderMap:
    """A running spectrum over orders.

    Attributes
    ----------
    t : (n_t,)
    speed : (n_t,)
        Mean sliding speed of each segment.
    order : (n_order,)
        Angular frequency over speed: radians for each unit of sliding distance.
    power : (n_order, n_t) masked array
        Density over order; its integral is the mean square.  Masked where the frequency would be above pi/dt.
    """

    t: Floats
    speed: Floats
    order: Floats
    power: np.ma.MaskedArray


@answers
def sliding_speed(sol: Solution, contact: str, t: ArrayLike) -> Floats:
    """Slip speed (n_t,) of a contact, the length of its relative velocity."""
    checked_solution("sliding_speed", sol)
    return np.asarray(np.linalg.norm(sol.at(t).relative_velocity(contact), axis=0))


@answers
def order_map(running: Spectrogram, speed: ArrayLike, order: ArrayLike) -> OrderMap:
    """A spectrogram over orders, omega = order times speed, in place of frequencies.

    What is tied to the surface (a pattern of the disc) stays at one order while the speed changes; what is tied to the
    structure stays at one frequency.

    Parameters
    ----------
    running : Spectrogram
    speed : (n_t,) array_like
        Sliding speed at ``running.t`` (:func:`sliding_speed`), at least 0.
    order : (n_order,) array_like
        Radians for each unit of sliding distance.

    Returns
    -------
    OrderMap

    Raises
    ------
    AnalysisError
        Speeds that do not match the times or are negative.
    """
    checked_kind("order_map", "running", running, Spectrogram, "what spectrogram returns")
    v = checked_numbers("order_map", "speed", speed, "(n_t,) numbers")
    wanted = checked_numbers("order_map", "order", order, "(n_order,) numbers")
    if v.shape != running.t.shape or not (np.isfinite(v).all() and (v >= 0.0).all()):
        raise AnalysisError(
            f"order_map: speed must be {running.t.shape} finite numbers of at least 0; got shape {v.shape}"
        )
    if wanted.ndim != 1 or not (np.isfinite(wanted).all() and (wanted >= 0.0).all()):
        raise AnalysisError("order_map: order must be (n_order,) finite numbers of at least 0")
    omega = wanted[:, None] * v
    power = np.stack([v[i] * np.interp(omega[:, i], running.omega, running.power[:, i]) for i in range(v.size)], axis=1)
    hidden = (omega > running.omega[-1]) | (v == 0.0)
    return OrderMap(t=running.t, speed=v, order=wanted, power=np.ma.MaskedArray(power, mask=hidden))
