"""Pad and rotor of a disc brake in their plane, by modes of finite element models."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

import fricmb as fm
from fricmb.errors import shown
from fricmb.values import SI, counted

from ._arguments import checked

Floats = NDArray[np.float64]

#: More contacts than anybody declares; the factors of the number are looked for.
MOST_CONTACTS = 1_000_000


@dataclass(frozen=True, kw_only=True)
class PadRotorModes:
    """Modes of pad and rotor on a grid of radii and angles under the pad.

    Attributes
    ----------
    radii, angles : (n_r,), (n_phi,)
        The grid; one of each will do.
    pad_frequencies, rotor_frequencies : (n,)
        Angular; the rotor's first is 0, its rotation.
    pad_shapes, rotor_shapes : (2, n_r, n_phi, n)
        Tangential and radial displacement of each mode.
    pad_masses, rotor_masses : (n,), optional
        Modal masses; default 1.
    """

    radii: Floats
    angles: Floats
    pad_frequencies: Floats
    pad_shapes: Floats
    rotor_frequencies: Floats
    rotor_shapes: Floats
    pad_masses: Floats | None = None
    rotor_masses: Floats | None = None

    def at(self, shapes: Floats, r: float, phi: float) -> Floats:
        """Shapes (2, n) at a radius and an angle, by cubic splines over the grid."""
        if len(self.radii) == len(self.angles) == 1:
            return shapes[:, 0, 0]
        # a spline through given values is linear in them: what each value of an axis counts is found once for all modes
        found: Floats = np.einsum(
            "i,j,cijn->cn", _weights(tuple(self.radii), r), _weights(tuple(self.angles), phi), shapes
        )
        return found


@lru_cache(maxsize=256)
def _weights(axis: tuple[float, ...], at: float) -> Floats:
    """What the values (n,) along an axis count at a place: cubic splines through 1 at one of them, 0 at the others."""
    from scipy.interpolate import make_interp_spline  # slow to import, and no other model needs it

    found: Floats = make_interp_spline(axis, np.eye(len(axis)), k=3)(at)
    return found


@cache
def stored_modes() -> PadRotorModes:
    """The modes that come with the package; ``tools/pad_rotor_modes.py`` computes them."""
    with (files("fricmb.models") / "data" / "pad_rotor.npz").open("rb") as file, np.load(file) as data:
        return PadRotorModes(**{name: np.asarray(data[name], dtype=float) for name in data.files})


@checked
def pad_rotor(
    n_pad_modes: int = 3,
    n_rotor_modes: int = 4,
    n_contacts: int | tuple[int, int] = 1,
    *,
    normal_force: float = 2000.0,
    pressure: Callable[[float, float], float] | None = None,
    mu_s: float = 0.45,
    mu_k: float = 0.40,
    law: fm.FrictionLaw | None = None,
    speed: float = 1.0,
    rotor_velocity: dict[str, float] | None = None,
    pad_damping: float = 0.01,
    rotor_damping: float = 0.001,
    modes: PadRotorModes | None = None,
) -> fm.Scene:
    """Pad and rotor of a disc brake in their plane: elastic bodies that rub on a grid of contacts.

    SI units.  The rotor is an annulus of cast iron (radii 75 and 140 mm, 20 mm thick) on a rigid hub that carries the
    inertia of a bench: its rotation, then circumferential modes and pairs of radial ones.  The pad is an annular sector
    of friction material on a steel back (radii 95 to 137 mm, 50 degrees) on its mounting.  At each contact x is the
    tangent, y the radius.

    Parameters
    ----------
    n_pad_modes, n_rotor_modes : int
        Elastic modes, lowest first, 1 to 40 and 0 to 40; the rotor's rotation comes on top.
    n_contacts : int or (int, int)
        Along the radius and along the angle; an int is divided into a grid that is wider along the angle.
    normal_force : float
        Of the whole pad (N).
    pressure : callable, optional
        ``pressure(r, phi)`` in proportion, r in m, phi in rad from the middle of the pad; default: uniform.
    mu_s, mu_k : float
        Coefficients of friction; not used with ``law``.
    law : FrictionLaw, optional
    speed : float
        Surface velocity of the rotor at the middle of the pad at the start (m/s).
    rotor_velocity : dict, optional
        Other initial modal velocities of the rotor, ``{"mode2": ...}``.
    pad_damping, rotor_damping : float
        Damping ratios of elastic modes.
    modes : PadRotorModes, optional
        Other modal data.

    Returns
    -------
    Scene
        Bodies pad and rotor (rotor.mode1 is the rotation); points and contacts c1, c2, ...

    Raises
    ------
    SceneError

    Notes
    -----
    Modes of the rotor stand in the frame of the pad: the surface speed is far below that of bending waves, so that
    convective and gyroscopic terms are left out.  In plane stress; bending of the disc is not in the model.
    """
    data = stored_modes() if modes is None else modes
    if not isinstance(data, PadRotorModes):
        raise fm.SceneError(f"pad_rotor: modes must be a PadRotorModes; got {shown(modes)}")
    pad_count = _count("n_pad_modes", n_pad_modes, 1, len(data.pad_frequencies))
    rotor_count = 1 + _count("n_rotor_modes", n_rotor_modes, 0, len(data.rotor_frequencies) - 1)
    places = _grid(data, n_contacts)
    weights = np.array([r * (1.0 if pressure is None else pressure(r, phi)) for r, phi in places])
    if not np.isfinite(weights).all() or (weights < 0.0).any() or weights.sum() <= 0.0:
        raise fm.SceneError("pad_rotor: pressure must give finite numbers >= 0, not all 0")
    loads = normal_force * weights / weights.sum()
    middle = (0.5 * (data.radii[0] + data.radii[-1]), 0.5 * (data.angles[0] + data.angles[-1]))
    turning = data.at(data.rotor_shapes[..., :1], *middle)[0, 0]
    pad = _body("pad", data, data.pad_frequencies, data.pad_shapes, data.pad_masses, pad_count, places, pad_damping)
    rotor = _body(
        "rotor", data, data.rotor_frequencies, data.rotor_shapes, data.rotor_masses, rotor_count, places, rotor_damping,
        velocity={"mode1": speed / turning, **(rotor_velocity or {})},
    )  # fmt: skip
    friction = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k) if law is None else law
    contacts = [
        fm.Contact(f"c{i + 1}", pad.point(f"p{i + 1}"), rotor.point(f"p{i + 1}"), law=friction, normal_force=float(N))
        for i, N in enumerate(loads)
    ]
    name = f"pad and rotor, {pad_count} + {rotor_count} modes, {counted(len(places), 'contact')}"
    return fm.Scene(name, [pad, rotor, *contacts], units=SI)


def _count(name: str, value: Any, low: int, high: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise fm.SceneError(f"pad_rotor: {name} must be an integer from {low} to {high}; got {shown(value)}")
    return value


def _grid(data: PadRotorModes, n_contacts: Any) -> list[tuple[float, float]]:
    """Middles of equal cells of the pad."""
    if isinstance(n_contacts, int) and not isinstance(n_contacts, bool) and 1 <= n_contacts <= MOST_CONTACTS:
        across = max(k for k in range(1, math.isqrt(n_contacts) + 1) if n_contacts % k == 0)
        counts = across, n_contacts // across
    else:
        counts = n_contacts
    good = isinstance(counts, tuple) and len(counts) == 2
    if not good or not all(isinstance(k, int) and not isinstance(k, bool) and k >= 1 for k in counts):
        raise fm.SceneError(
            f"pad_rotor: n_contacts must be an integer from 1 to {MOST_CONTACTS} or a pair of them;"
            f" got {shown(n_contacts)}"
        )
    r, phi = (
        axis[0] + (axis[-1] - axis[0]) * (np.arange(k) + 0.5) / k
        for k, axis in zip(counts, (data.radii, data.angles), strict=True)
    )
    return [(float(a), float(b)) for a in r for b in phi]


def _body(
    name: str, data: PadRotorModes, frequencies: Floats, shapes: Floats, masses: Floats | None, count: int,
    places: list[tuple[float, float]], ratio: float, velocity: dict[str, float] | None = None,
) -> fm.ModalBody:  # fmt: skip
    kept = shapes[..., :count]
    return fm.ModalBody(
        name,
        frequencies=frequencies[:count],
        damping_ratios=np.where(frequencies[:count] > 0.0, ratio, 0.0),
        masses=None if masses is None else masses[:count],
        shapes={f"p{i + 1}": data.at(kept, *place) for i, place in enumerate(places)},
        axes="xy",
        velocity=velocity or {},
    )
