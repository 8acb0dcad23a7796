"""Friction that differs by direction: a cone whose centre is not at 0."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from fricmb.errors import LawError
from fricmb.laws._base import FrictionLaw
from fricmb.laws.vector._shaped import Shaped
from fricmb.values import value_of

#: Slip speed below which numbers of a law go to 0, so that nothing overflows.
_SLOW = 1e-100


@dataclass(frozen=True, kw_only=True)
class Offset(Shaped):
    """Friction of ``law`` about a centre that is not 0: ``F + offset N`` is within its cone, and opposes slip on it.

    In one direction it differs by the sense of slip: coefficients of slip are ``mu(r) + offset`` forward (v > 0) and
    ``mu(r) - offset`` back, and a contact sticks while ``-(mu_s + offset) N <= F <= (mu_s - offset) N``;
    :meth:`by_sense` takes these coefficients.  In two directions the cone is a disc (with :class:`Elliptic` an ellipse)
    about ``-offset N``: bristles, fish skin, snakes, drives whose friction is another each way.

    Parameters
    ----------
    law : FrictionLaw
        Set-valued, a function of the slip speed.
    offset : float, or two of them
        Coefficient along each direction of the contact.  0 stays in the cone of slow slip: without a force nothing
        sets out, and all slip dissipates.
    rest_offset : float, optional
        The same at rest, in one direction, where break-away exceeds slip by different amounts in the two senses
        (default: ``offset``).  Break-away is below slip in neither.

    Raises
    ------
    LawError
        If an offset is beyond the cone, or the law not set-valued.

    Notes
    -----
    The normal force of the contact is a number or an expression.  In ``sol.energy`` what the offset takes is part of
    the friction loss under a number, and input under an expression.  A curve inside falls by the same amount
    in both senses.  With a ``rest_offset`` ``radau`` and ``bdf`` locate break-away in both senses; other methods,
    derivatives, and contacts that are redundant refuse it.

    References
    ----------
    F. L. Chernousko, The optimum rectilinear motion of a two-mass system, Journal of Applied Mathematics and Mechanics
    66 (2002) 1-7 (friction that differs by sense); A. Zmitrowicz, Mathematical descriptions of anisotropic friction,
    International Journal of Solids and Structures 25 (1989) 837-862 (no symmetry about 0).

    Examples
    --------
    >>> law = Offset.by_sense(mu_s=(0.2, 0.6))
    >>> law.force([1.0], 10.0).tolist(), law.force([-1.0], 10.0).tolist()
    ([-2.0], [6.0])
    """

    isotropic: ClassVar[bool] = False

    offset: Any
    rest_offset: Any = None

    @property
    def dimensions(self) -> tuple[int, ...]:  # type: ignore[override]
        """As many directions as offsets."""
        return (len(self.offsets()),)

    def offsets(self) -> tuple[Any, ...]:
        """One for each direction."""
        return self.offset if isinstance(self.offset, tuple) else (self.offset,)

    def rest_offsets(self) -> tuple[Any, ...]:
        """Centre of the cone at rest."""
        return self.offsets() if self.rest_offset is None else (self.rest_offset,)

    def lean(self) -> float:
        """How far that is off the centre in slip, over the break-away coefficient."""
        if self.rest_offset is None:
            return 0.0
        shift = float(value_of(self.rest_offset)) - float(value_of(self.offset))
        return shift / self.break_away() if shift else 0.0

    @property
    def centred(self) -> FrictionLaw:
        """The law inside."""
        law: FrictionLaw = self.law
        return law

    def axis_scale(self) -> tuple[Any, ...]:
        """That of the law inside."""
        scale: tuple[Any, ...] = self.law.axis_scale()
        return scale

    def force(self, v_rel: Any, normal_force: Any, state: Any = None) -> Any:
        """Of the law inside, less the offset; 0 at v = 0."""
        found = np.asarray(self.law.force(v_rel, normal_force, state))
        if (len(found) if found.ndim else 1) not in self.dimensions:
            self._refuse("v_rel", v_rel, f"of {self.dimensions[0]} direction(s)")
        shift = np.array([value_of(c) for c in self.offsets()], dtype=float)
        r = np.abs(np.asarray(v_rel, dtype=float))
        r = r.max(axis=0) if found.ndim else r
        share = r / np.maximum(r, _SLOW)
        shift = shift.reshape(-1, *(1,) * (found.ndim - 1)) if found.ndim else shift[0]
        whole = found - shift * np.asarray(normal_force, dtype=float) * share
        return whole if whole.ndim else float(whole)

    def validate(self) -> None:
        """0 is in the cone of slow slip, and the law inside has as many directions."""
        d = len(self.offsets())
        if d not in (1, 2) or d not in self.law.dimensions:
            self._refuse("offset", self.offset, f"one number for each direction of {type(self.law).__name__}")
        scale = self.law.axis_scale() or (1.0,) * d
        size = math.hypot(*(float(c) / float(s) for c, s in zip(self.offsets(), scale, strict=True)))
        if size > self.law.slip_limit() * (1 + 1e-12):
            self._refuse("offset", self.offset, f"within the cone of slow slip, of size {self.law.slip_limit():g}")
        if self.rest_offset is None:
            return
        if isinstance(self.offset, tuple):
            self._refuse("rest_offset", self.rest_offset, "left out in two directions")
        excess = self.break_away() - self.law.slip_limit()
        if abs(float(self.rest_offset) - float(self.offset)) > excess * (1 + 1e-12):
            self._refuse("rest_offset", self.rest_offset, f"within {excess:g} of offset: break-away is not below slip")

    def check(self) -> None:
        """The law inside is set-valued and has its centre at 0."""
        law = self.law
        if not isinstance(law, FrictionLaw) or law.kind == "smooth" or any(law.offsets()) or law.load_dependent:
            self._refuse("law", law, "a set-valued law of the slip speed, such as fm.laws.Coulomb(mu_s=0.5)")
        super().check()

    @classmethod
    def by_sense(cls, *, mu_s: tuple[Any, Any], mu_k: tuple[Any, Any] | None = None) -> Self:
        """Coulomb's law with coefficients (forward, back).

        Parameters
        ----------
        mu_s, mu_k : (float, float)
            Of break-away, and of slip (None: those of break-away), >= 0.

        Raises
        ------
        LawError
            If break-away exceeds slip by different amounts forward and back.
        """
        from fricmb.laws.set_valued import Coulomb

        for name, pair in (("mu_s", mu_s), ("mu_k", mu_k)):
            if pair is not None and (not isinstance(pair, tuple | list) or len(pair) != 2):
                raise LawError(f"Offset.by_sense: {name} must be two coefficients (forward, back), got {pair!r}")
        slip = mu_s if mu_k is None else mu_k
        excess = [float(value_of(s)) - float(value_of(k)) for s, k in zip(mu_s, slip, strict=True)]
        round_off = 1e-12 * max(abs(float(value_of(c))) for c in mu_s)
        if min(excess) < -round_off:
            raise LawError(f"Offset.by_sense: mu_k must be at most mu_s forward and back, got {slip!r} above {mu_s!r}")
        law = Coulomb(mu_s=(mu_s[0] + mu_s[1]) / 2, mu_k=None if mu_k is None else (mu_k[0] + mu_k[1]) / 2)
        rest = (mu_s[0] - mu_s[1]) / 2 if abs(excess[0] - excess[1]) > round_off else None
        return cls(law=law, offset=(slip[0] - slip[1]) / 2, rest_offset=rest)

    @classmethod
    def example(cls) -> Self:
        """Bristles: three times the friction against their lie."""
        return cls.by_sense(mu_s=(0.2, 0.6))
