"""Ends of a way, and play, that do not give: impacts at the limits of a coordinate."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.scene._axes import direction
from fricmb.scene._forms import LinearForm
from fricmb.scene._guided_way import along, check_way, guide_coordinates
from fricmb.scene._joint import Joint
from fricmb.scene._one_coordinate import ANGLE
from fricmb.scene._restitution import check_restitution
from fricmb.scene._rigid import angle_of
from fricmb.scene._turning import relative_angle
from fricmb.values import value_of


@dataclass(frozen=True, eq=False)
class _RigidLimits(Joint):
    """A coordinate between limits; each of them pushes only, and what meets it leaves with a part of its speed."""

    constrains: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis", "guide")
    _: KW_ONLY
    axis: Any = None
    restitution: Any
    guide: Any = None
    angle: Any = None

    def __post_init__(self) -> None:
        self._check_axis()
        super().__post_init__()
        check_restitution(self, "restitution", self.restitution)
        self._check_limits()
        self.local_coordinates()

    def _check_axis(self) -> None:
        """Refuse an axis that is not accepted, and take what a joint stands for."""
        check_way(self)

    def _check_limits(self) -> None:
        """Refuse limits that are not accepted."""

    def _label(self) -> str:
        return f"{type(self).__name__.removeprefix('Rigid')} {self.name!r}"

    @property
    def one_sided(self) -> bool:
        """Limits only push."""
        return True

    @property
    def hands_over(self) -> bool:
        """They let go."""
        return True

    def limits(self) -> tuple[Any, Any]:
        """Lower and upper limit of the coordinate; None where there is none."""
        raise NotImplementedError

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """What is limited; along a guide as :func:`guide_coordinates`."""
        if self.guide is not None:
            return guide_coordinates(self)
        if self.axis == ANGLE:
            return (relative_angle(self, self.a, self.b),)
        return (direction(self, "axis", self.axis, self.a, self.b).form,)

    def _scale(self) -> Any:
        """Factor of a second local coordinate in what is limited."""
        return 0.0

    def sides(self) -> tuple[Joint, ...]:
        """One joint for each limit, "lower" and "upper" behind the name where there are two."""
        limits = zip((LowerSide, UpperSide), self.limits(), strict=True)
        angle = 0.0 if self.guide is None else float(value_of(self.angle))
        found = tuple(
            kind(self.name, self.a, self.b, of=self, limit=value_of(limit), ratio=self._scale(), angle=angle)
            for kind, limit in limits
            if limit is not None
        )
        if len(found) == 2:
            for side, word in zip(found, ("lower", "upper"), strict=True):
                side._set("name", f"{self.name}.{word}")
        return found


@dataclass(frozen=True, eq=False)
class RigidSide(Joint):
    """One limit of a coordinate, that of the part ``of``."""

    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "of")
    _: KW_ONLY
    of: Any
    limit: Any
    ratio: Any
    angle: Any

    def _label(self) -> str:
        found: str = self.of._label()
        return found

    @property
    def one_sided(self) -> bool:
        """It pushes only."""
        return True

    @property
    def hands_over(self) -> bool:
        """It lets go."""
        return True

    @property
    def impact(self) -> tuple[float, float, float] | None:
        """Restitution of its part; there is no slip."""
        return float(value_of(self.of.restitution)), 0.0, 0.0

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Those of its part."""
        found: tuple[LinearForm, ...] = self.of.local_coordinates()
        return found

    def limited(self, x: tuple[Any, ...]) -> Any:
        """The coordinate; of three local ones the way along a guide."""
        if len(x) == 3:
            import sympy

            return along(x, self.angle, sympy)
        return x[0] if len(x) == 1 else x[0] + self.ratio * x[1]


@dataclass(frozen=True, eq=False)
class LowerSide(RigidSide):
    """What a coordinate is at least."""

    @property
    def side(self) -> int:
        """-1."""
        return -1

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance from the limit."""
        return (self.limited(x) - self.limit,)


@dataclass(frozen=True, eq=False)
class UpperSide(RigidSide):
    """What a coordinate is at most."""

    @property
    def side(self) -> int:
        """1."""
        return 1

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance from the limit."""
        return (self.limit - self.limited(x),)


@dataclass(frozen=True, eq=False)
class RigidStop(_RigidLimits):
    """What :class:`Stop` makes of ``restitution=``: ends of a way that do not give."""

    _: KW_ONLY
    lower: Any = None
    upper: Any = None

    def _check_limits(self) -> None:
        if self.lower is None and self.upper is None:
            raise SceneError(f"{self._label()}: lower or upper must be given")
        if self.lower is not None and self.upper is not None and value_of(self.lower) >= value_of(self.upper):
            self._refuse("upper", self.upper, f"above lower = {value_of(self.lower):g}")

    def limits(self) -> tuple[Any, Any]:
        """The limits as declared."""
        return self.lower, self.upper


@dataclass(frozen=True, eq=False)
class RigidBacklash(_RigidLimits):
    """What :class:`Backlash` makes of ``restitution=``: flanks that do not give."""

    positive: ClassVar[tuple[str, ...]] = ("gap",)
    _: KW_ONLY
    gap: Any
    ratio: Any = None

    def _check_axis(self) -> None:
        if self.ratio is None:
            super()._check_axis()
            return
        if self.axis is not None:
            self._refuse("ratio", self.ratio, "left out beside axis")
        if value_of(self.ratio) == 0.0:
            self._refuse("ratio", self.ratio, "another than 0")

    def limits(self) -> tuple[Any, Any]:
        """Half the gap on each side."""
        half = float(value_of(self.gap)) / 2
        return -half, half

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The play, or both angles of wheels in mesh."""
        if self.ratio is None:
            return super().local_coordinates()
        return angle_of(self, "a", self.a), angle_of(self, "b", self.b)

    def _scale(self) -> Any:
        return 0.0 if self.ratio is None else float(value_of(self.ratio))
