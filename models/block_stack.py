"""Blocks stacked on a moving table, each rubbing on the one below."""

from __future__ import annotations

from collections.abc import Sequence

import fricmb as fm
from fricmb.errors import shown
from fricmb.values import SI

from ._arguments import checked


@checked
def block_stack(
    n: int = 3,
    *,
    mass: float | Sequence[float] = 1.0,
    gravity: float = 9.81,
    mu_s: float | Sequence[float] = (0.5, 0.3, 0.2),
    mu_k: float | Sequence[float] | None = None,
    table: float = 1.0,
    velocity: float | Sequence[float] = 0.0,
) -> fm.Scene:
    """Stack of blocks on a moving table: contacts coupled through the bodies between them.

    SI units (kg, m, s) by default.  The normal force of each contact is the weight of all blocks above it.

    Parameters
    ----------
    n : int
        Number of blocks.
    mass : float or sequence of n
        From the lowest block up.
    gravity : float
    mu_s, mu_k : float or sequence of n
        Coefficients of friction, from the table up; ``mu_k`` defaults to ``mu_s``.
    table : float
        Velocity of the table along x.
    velocity : float or sequence of n
        Of the blocks at the start.

    Returns
    -------
    Scene
        Dofs block1.x (lowest), block2.x, ...; contacts "joint1" (on the table), "joint2", ...

    Notes
    -----
    Accelerations are constant between transitions, so each motion has a closed form; by default block k is caught after
    table/(0.9 g), table/(0.4 g) and table/(0.2 g).
    """
    if not isinstance(n, int) or n < 1:
        raise fm.SceneError(f"block_stack: n must be an integer of at least 1; got {shown(n)}")
    masses = _each("mass", mass, n)
    statics = _each("mu_s", mu_s, n)
    kinetics = statics if mu_k is None else _each("mu_k", mu_k, n)
    velocities = _each("velocity", velocity, n)
    blocks = [fm.Body(f"block{i + 1}", mass=masses[i], velocity={"x": velocities[i]}) for i in range(n)]
    floor = fm.Driven("table", velocity={"x": table})
    contacts = [
        fm.Contact(
            f"joint{i + 1}",
            blocks[i],
            blocks[i - 1] if i else floor,
            law=fm.laws.Coulomb(mu_s=statics[i], mu_k=kinetics[i]),
            normal_force=gravity * sum(masses[i:]),
        )
        for i in range(n)
    ]
    return fm.Scene(f"stack of {n} blocks", [*blocks, floor, *contacts], units=SI)


def _each(name: str, value: float | Sequence[float], n: int) -> tuple[float, ...]:
    """One value a block, from a number or a sequence of n."""
    if isinstance(value, Sequence):
        if len(value) != n:
            raise fm.SceneError(f"block_stack: {name} must be a number or {n} of them; got {len(value)}")
        return tuple(value)
    return (value,) * n
