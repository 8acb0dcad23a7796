"""The protocol of joints: what ties ends together, and the friction of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, fields
from typing import Any, ClassVar, Self

from fricmb.errors import SceneError
from fricmb.laws import FrictionLaw
from fricmb.scene._axes import check_ends
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND, End, Part
from fricmb.values import Parameter, is_expression, is_plain


@dataclass(frozen=True, eq=False)
class Joint(Part):
    """Base of joints.

    An author writes a frozen dataclass with its ends and numbers, and states

    - :meth:`local_coordinates`: the coordinates x it depends on, as linear forms in named motions;
    - :meth:`define_constraint`: expressions in x that stay 0, in SymPy, where numeric fields are symbols.

    Every constraint has a multiplier ``lam``, and ``lam dphi/dx`` is the force on x: that is ``sol.reaction(name)``.
    All derivatives are derived, once for each type.  A joint that takes a friction law also states

    - :meth:`define_slip`: factors s(x) of the slip velocity ``s . x'``; with :attr:`slip_rows` > 1 a tuple of such;
    - :meth:`define_load`: the normal force N(x, lam) >= 0.

    A joint that constrains nothing (:attr:`constrains` is False: it presses and rubs) states these two alone, and in
    :meth:`parts_within` the element that presses; it is open where N < 0.

    Parameters
    ----------
    name : str
    a, b : RigidBody, one of its points, Body, Driven, ground_point(x, y) or GROUND
        b defaults to GROUND.
    friction : FrictionLaw, optional
        Its force opposes the slip of a relative to b.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> import fricmb as fm
    >>> @dataclass(frozen=True, eq=False)
    ... class Parabola(fm.Joint):
    ...     '''Keeps a point on y = x^2.'''
    ...     def local_coordinates(self):
    ...         return (self.a.motion("x"), self.a.motion("y"))
    ...     def define_constraint(self, x):
    ...         return (x[1] - x[0] ** 2,)
    >>> bead = fm.Body("bead", mass=1.0, axes="xy")
    >>> len(fm.Scene("bowl", [bead, Parabola("wire", bead), fm.Gravity("g")]).joints)
    1
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b")
    #: Fields that are no part of its formulas.
    _beside: ClassVar[frozenset[str]] = frozenset(("friction",))
    #: Whether the joint has slip and load.
    takes_friction: ClassVar[bool] = False
    #: Whether reaction and friction are mean and difference of two tensions (``sol.tensions``).
    has_tensions: ClassVar[bool] = False
    #: Number of directions of slip.
    slip_rows: ClassVar[int] = 1
    #: Whether its constraints depend on the motion of its ends relative to one another alone: they stay satisfied where
    #: both ends are moved and turned as one.
    only_relative: ClassVar[bool] = False
    #: Whether it has constraints.
    constrains: ClassVar[bool] = True

    a: End
    b: End = GROUND
    _: KW_ONLY
    friction: FrictionLaw | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        a, b = check_ends(self, self.a, self.b)
        if a.owner is b.owner:
            raise SceneError(f"{self._label()}: a and b must belong to different parts, both are of {a.owner.name!r}")
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name in self._fixed or self._takes_expression(field.name):
                continue
            if is_plain(value) or isinstance(value, Parameter) or is_expression(value):
                self._set(field.name, self._number(field.name, value))
        # one number each: what is none would go unseen until formulas are made of it
        for name in self.positive:
            self._set(name, self._number(name, getattr(self, name), above=0.0))
        if self.friction is not None:
            if not self.takes_friction:
                self._refuse("friction", self.friction, "left out: this joint has no slip")
            if not isinstance(self.friction, FrictionLaw):
                self._refuse("friction", self.friction, "a friction law, such as fm.laws.Coulomb(mu_s=0.5)")
            self._check_directions(self.friction)
            if self.friction.offsets():
                self._refuse("friction", self.friction, "a law without an offset")
            if self.slip_rows > 1 and self.friction.numeric().axis_scale():
                self._refuse("friction", self.friction, "a law that is the same in all directions of slip")
            if type(self.friction).__post_init__ is not FrictionLaw.__post_init__:
                self.friction.check()

    def _check_directions(self, law: FrictionLaw) -> None:
        """Refuse a law that does not serve as many directions of slip.

        The third direction of laws that state three is spin; three that are alike take a law with a cone.
        """
        if self.slip_rows > 2 and not law.cone_in_space:
            self._refuse("friction", law, f"a law that sticks, with a cone in {self.slip_rows} directions of slip")
        if self.slip_rows <= 2 and self.slip_rows not in law.dimensions:
            words = "one direction" if self.slip_rows == 1 else f"{self.slip_rows} directions"
            self._refuse("friction", law, f"a law of {words} of slip")

    def bare(self) -> Self:
        """The same without its law and what impacts are like, whose numbers are no part of the joint's formulas."""
        copy = object.__new__(type(self))
        for field in fields(self):
            object.__setattr__(copy, field.name, None if field.name in self._beside else getattr(self, field.name))
        return copy

    @property
    def law(self) -> FrictionLaw | None:
        """The friction law."""
        return self.friction

    def _takes_expression(self, field: str) -> bool:
        """Whether a field may hold an expression of time."""
        return False

    @property
    def one_sided(self) -> bool:
        """Whether its single multiplier pushes only (lam >= 0)."""
        return False

    @property
    def relative(self) -> bool:
        """Whether the joint sees no more than the relative motion of two ends that turn."""
        return self.only_relative and all(
            hasattr(end.owner, "inertia") or not getattr(end.owner, "dof_names", ()) for end in (self.a, self.b)
        )

    @property
    def hands_over(self) -> bool:
        """Whether a one-sided joint whose contact is lost lets go and the run goes on without it."""
        return False

    @property
    def loaded_by(self) -> str:
        """The joint whose multipliers are the ``lam`` of :meth:`define_load`, of one that holds nothing; "": none."""
        return ""

    @property
    def load_rows(self) -> int:
        """How many multipliers that joint has."""
        return 0

    @property
    def impact(self) -> tuple[float, float, float] | None:
        """Restitution along the normal and along slip, friction in impacts (nan: that of slip); None: not computed."""
        return None

    @property
    def side(self) -> int:
        """-1 for the lower and 1 for the upper end of a part that becomes two joints; else 0."""
        return 0

    @property
    def is_rigid(self) -> bool:
        """Whether impacts on it are computed."""
        return any(side.impact is not None for side in self.sides())

    def sides(self) -> tuple[Joint, ...]:
        """The joints that it is made of: itself, but for a part with two ends."""
        return (self,)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The coordinates x that the joint depends on; their velocities follow."""
        raise NotImplementedError(f"{type(self).__name__} must define local_coordinates(self)")

    def labels(self) -> tuple[str, ...]:
        """Names of the directions of slip."""
        return ("t",) if self.slip_rows == 1 else tuple(str(i + 1) for i in range(self.slip_rows))

    def drives(self) -> tuple[Any, ...]:
        """Prescribed functions of time that follow in x: ("value" or "rate", expression, start)."""
        return ()

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Expressions that stay 0."""
        if not self.constrains:
            return ()
        raise NotImplementedError(f"{type(self).__name__} must define define_constraint(self, x)")

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Factors of the rates x' in the slip velocity of a relative to b; of several directions a tuple of such."""
        raise NotImplementedError(f"{type(self).__name__} must define define_slip(self, x)")

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Normal force of the friction, >= 0."""
        raise NotImplementedError(f"{type(self).__name__} must define define_load(self, x, lam)")

    def define_load_rates(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Factors d(x) of what ``d . x'`` adds to the normal force (a damper in the contact); none: ()."""
        return ()

    def undefined(self, values: Mapping[str, float]) -> str:
        """Why the joint has no meaning at positions of the degrees of freedom, a sentence; "" where it has."""
        return ""

    def observed(self) -> dict[str, LinearForm]:
        """Relative motions of the joint by name (its joint coordinates): ``sol["hinge.angle"]``."""
        return {}


def kept_distance(x: tuple[Any, ...], length: Any) -> tuple[Any, ...]:
    """That the vector x has a length: a constraint of unit slope along it."""
    return (sum(c**2 for c in x) / (2 * length) - length / 2,)
