"""A drum in a band."""

from __future__ import annotations

from math import pi

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def band_brake(
    *,
    inertia: float = 0.9,
    radius: float = 0.2,
    speed: float = 40.0,
    angle: float = 1.5 * pi,
    mu: float = 0.3,
    pull: float = 60.0,
    stiffness: float = 2e4,
    lever: float = 0.5,
    damping: float = 20.0,
) -> fm.Scene:
    """Band brake: a drum turns in a band held at one end and pulled at the other; self-energising one way.

    SI units.

    Parameters
    ----------
    inertia, radius : float
        Of the drum.
    speed : float
        Of the drum at the start; > 0 drags the band off its holder, which bears more: the brake is self-energising.
    angle : float
        Angle of wrap of the band on the drum.
    mu : float
        Coefficient of friction of the band.
    pull : float
        Force on the end of the band.
    stiffness, damping : float
        Of the holder of the other end.
    lever : float
        Mass of the holder, and of the lever that pulls.

    Returns
    -------
    Scene
        Bodies drum, holder and lever, joints hub and band, whose friction is that of the brake.

    Notes
    -----
    While the band slips on a drum of positive speed the steady moment is ``radius pull (e^(mu angle) - 1)``, of
    negative speed ``radius pull (1 - e^(-mu angle))``: see :class:`fricmb.Rope`.
    """
    check_positive("band_brake", radius=radius)
    drum = fm.RigidBody("drum", mass=2.0 * inertia / radius**2, inertia=inertia, angular_velocity=speed)
    holder = fm.Body("holder", mass=lever, position={"x": 2.0 * radius})
    end = fm.Body("lever", mass=lever, axes="y", position={"y": 2.0 * radius})
    return fm.Scene(
        "band brake",
        [
            drum,
            holder,
            end,
            fm.Revolute("hub", drum),
            fm.Rope("band", (holder, end), axes=("x", "y"), drum=drum, radius=radius, angle=angle, friction=mu),
            fm.Spring("anchor", holder, axis="x", stiffness=stiffness, length=2.0 * radius),
            fm.Damper("mount", holder, axis="x", damping=damping),
            fm.Force("pull", end, axis="y", value=pull),
        ],
        units=SI,
    )
