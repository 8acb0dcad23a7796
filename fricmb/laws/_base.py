"""What every friction law states, and what every friction law can compute."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, ClassVar, Literal, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb._calls import answers
from fricmb._facade import facade
from fricmb.errors import FricmbError, LawError
from fricmb.laws._check import (
    check_cone,
    check_copies,
    check_said,
    field_value,
    no_fields,
    no_numbers,
    required_numbers,
)
from fricmb.laws._regimes import Regimes
from fricmb.values import Declaration, value_of
from fricmb.values._declaration import field_names

Floats: TypeAlias = NDArray[np.float64]
LawKind: TypeAlias = Literal["constant", "coefficient", "smooth"]


@dataclass(frozen=True, kw_only=True)
class FrictionLaw(Regimes, Declaration):
    """Base of all friction laws.

    A law is a frozen dataclass; its fields are its parameters (numbers, or tuples of numbers).  It states either a
    coefficient (:meth:`define_coefficient`): set-valued friction that sticks inside the cone ``|F| <= mu_s N`` and
    opposes slip with ``mu(r) N``; or a force (:meth:`define_force`), with or without internal states: such a law
    never sticks.  A force law may state a coefficient as well: its force in steady sliding.

    Fields named in the class attribute ``positive`` are checked to be > 0 and have positive symbols, which SymPy needs
    to simplify powers.  The length of a slip velocity is written ``fricmb.laws.norm(v)``: its derivatives are finite
    at 0.

    The break-away coefficient is the field ``mu_s``, if there is one that is not None, else the limit of the
    coefficient for r -> 0.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> import sympy
    >>> @dataclass(frozen=True, kw_only=True)
    ... class LogWeakening(FrictionLaw):
    ...     mu_s: float
    ...     slope: float
    ...     def define_coefficient(self, r):
    ...         return self.mu_s / (1 + self.slope * sympy.log(1 + r))
    >>> float(LogWeakening(mu_s=0.5, slope=0.1).coefficient(0.0))
    0.5
    """

    _error: ClassVar[type[FricmbError]] = LawError

    #: Names of internal states; each stands for one state per tangential direction (and see :meth:`copies`).
    states: ClassVar[tuple[str, ...]] = ()
    #: Those of ``states`` that are one number for the contact, whatever its directions (a contact's age).
    scalars: ClassVar[tuple[str, ...]] = ()
    #: Numbers of tangential directions that the law can serve; 3: two of sliding, and the rim speed of spin.
    dimensions: ClassVar[tuple[int, ...]] = (1, 2)
    #: Whether a rotation of the velocity rotates the force (checked by the conformance kit).
    isotropic: ClassVar[bool] = True
    #: Whether states stay as they are at rest; False where a contact ages.
    rests: ClassVar[bool] = True

    # -- what an author states ----------------------------------------------------------------------------------
    def define_coefficient(self, r: Any) -> Any:
        """mu(r) for slip speed r >= 0, in SymPy; ``(self, r, N)`` if it depends on the normal force too."""
        raise LawError(f"{type(self).__name__}: defines no coefficient")

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Force on the contact's a (a tuple, one for each direction), in SymPy.

        ``v``: relative velocity, one symbol for each tangential direction; ``N``: normal force; ``z``: states, name by
        name, copy by copy, each with one symbol for each direction (a scalar has one).  A force that opposes slip has
        the sign of ``-v``.
        """
        raise LawError(f"{type(self).__name__}: defines no force")

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Time derivative of the states ``z`` (a tuple of the same length), in SymPy."""
        raise LawError(f"{type(self).__name__}: has the states {', '.join(self.states)} but defines no rate")

    def define_switch(self, v: tuple[Any, ...], N: Any) -> Any | None:
        """Where a force law without states goes over from one formula to another with a jump in some derivative.

        An expression of the size of a force that changes its sign there, in SymPy; None: nowhere.  Runs of mechanisms
        end a step there.
        """
        return None

    def copies(self) -> Mapping[str, int]:
        """How many times a name in ``states`` occurs per direction, where that is not once (sliders side by side)."""
        return {}

    def validate(self) -> None:
        """Check the numbers (named parameters are replaced by theirs); raises :class:`LawError`."""

    def compiled_coefficient(self) -> Callable[..., None] | None:
        """A compiled coefficient in place of a symbolic one, or None.

        For laws that SymPy cannot state (tables): a plain module-level function ``f(x, p, out)`` that numba can
        compile on pointers to float64, with ``x = [r, N]``, ``p`` = :meth:`parameter_block` and
        ``out = [mu, d mu/d r, d mu/d N]``.  Such a law overrides :meth:`coefficient` and :meth:`derivative` as well.
        """
        return None

    def compiled_force(self, d: int) -> Callable[..., None] | None:
        """A compiled force in ``d`` directions in place of a symbolic one, or None.

        As :meth:`compiled_coefficient`, with ``x = [v (d), N, z]`` and ``out = [F (d), z', Jacobian by rows]`` (of F
        and z' with respect to x).  Such a law has ``kind`` "smooth".
        """
        return None

    def parameter_block(self) -> Floats:
        """The numbers a compiled law reads, in order; by default all slots one after the other."""
        parts = [np.atleast_1d(np.asarray(value, dtype=float)) for value in self.numeric_slots().values()]
        return np.concatenate(parts) if parts else np.zeros(0)

    @classmethod
    def example(cls) -> Self:
        """A typical instance: each required field gets 0.5 unless a law states other values."""
        return cls(**required_numbers(cls))

    # -- facts --------------------------------------------------------------------------------------------------
    @property
    def kind(self) -> LawKind:
        """``"constant"``, ``"coefficient"`` or ``"smooth"`` (a force law, which never sticks)."""
        own = type(self).define_force is not FrictionLaw.define_force
        return "smooth" if own or type(self).compiled_force is not FrictionLaw.compiled_force else "coefficient"

    def state_labels(self, directions: Sequence[str]) -> tuple[str, ...]:
        """Labels of all states over the given directions: "z", "z.x", "z2.x", "theta"."""
        if not self.states:
            return ()
        found = []
        for name in self.states:
            count = self.copies().get(name, 1)
            numbered = [name] if count == 1 else [f"{name}{i + 1}" for i in range(count)]
            over = [""] if name in self.scalars or len(directions) == 1 else [f".{c}" for c in directions]
            found += [f"{label}{c}" for label in numbered for c in over]
        return tuple(found)

    def n_states(self, d: int) -> int:
        """Number of states over ``d`` directions."""
        return len(self.state_labels("xyz"[:d]))

    def knots(self) -> tuple[float, ...]:
        """Slip speeds at which the slope of the coefficient bends; of a smooth curve none.

        Steps end there where that matters.  Where a formula goes over to another one is found from the formula, unless
        that depends on a normal force that varies; an own law overrides this to state what else is narrow and far from
        rest, such as the place of a peak.
        """
        return ()

    def axis_scale(self) -> tuple[Any, ...]:
        """Friction along the contact's directions relative to the first; () for an isotropic law.

        With S = diag(scale) and the scaled velocity S v the law is the isotropic one: F = -mu(|S v|) N S (S v)/|S v|.
        """
        return ()

    def offsets(self) -> tuple[Any, ...]:
        """Centre of the cone along the contact's directions: the force is that of :attr:`centred` less these times N.

        () for a cone about 0.
        """
        return ()

    def rest_offsets(self) -> tuple[Any, ...]:
        """The same of what a contact sticks by, where that has another centre."""
        return self.offsets()

    def lean(self) -> float:
        """Centre of the cone at rest less that in slip, over the break-away coefficient."""
        return 0.0

    def remark(self) -> str:
        """Sentence that the notes of a run with this law contain; "" for none."""
        return ""

    @property
    def centred(self) -> FrictionLaw:
        """The law about 0: itself, but for one with offsets."""
        return self

    @property
    def cone_in_space(self) -> bool:
        """Whether the law serves three directions that are alike: a cone, the same in all directions of slip."""
        return self.kind != "smooth" and 2 in self.dimensions and not self.axis_scale() and not self.offsets()

    @property
    def has_coefficient(self) -> bool:
        """Whether the law states a coefficient."""
        own = type(self).define_coefficient is not FrictionLaw.define_coefficient
        return own or self.compiled_coefficient() is not None

    @property
    def load_dependent(self) -> bool:
        """Whether the coefficient depends on the normal force: ``define_coefficient(self, r, N)``."""
        return len(inspect.signature(type(self).define_coefficient).parameters) > 2

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """Limit of the coefficient for r -> 0 in slip."""
        return float(self.coefficient(0.0, normal_force))

    @answers
    def break_away(self, normal_force: float = 1.0) -> float:
        """Coefficient up to which the contact sticks."""
        path = self.static_path
        return self.slip_limit(normal_force) if path is None else float(value_of(self.slots()[path]))

    @property
    def static_path(self) -> str | None:
        """Slot of the break-away coefficient, None where that is the limit of the coefficient for r -> 0."""
        return "mu_s" if getattr(self, "mu_s", None) is not None and "mu_s" in self.slots() else None

    # -- numbers ------------------------------------------------------------------------------------------------
    @answers
    def coefficient(self, r: ArrayLike, normal_force: ArrayLike = 1.0) -> Any:
        """Friction coefficient at slip speeds ``r`` >= 0 (of a force law: in steady sliding).

        Parameters
        ----------
        r : array_like
            Slip speed.
        normal_force : array_like
            Used by load-dependent laws alone.

        Returns
        -------
        float or ndarray
            Of the shape of ``r``.
        """
        from fricmb.laws._numeric import coefficient

        return coefficient(self, r, normal_force)

    @answers
    def derivative(self, r: ArrayLike, normal_force: ArrayLike = 1.0) -> Any:
        """Derivative of the coefficient with respect to the slip speed; arguments as in :meth:`coefficient`."""
        from fricmb.laws._numeric import derivative

        return derivative(self, r, normal_force)

    @answers
    def force(self, v_rel: ArrayLike, normal_force: ArrayLike, state: ArrayLike | None = None) -> Any:
        """Force on the contact's a while slipping at the relative velocity ``v_rel`` (a's velocity less b's).

        Parameters
        ----------
        v_rel : array_like, (d,) or (d, n_t) or a number
            First axis: the one or two tangential directions.
        normal_force : float or (n_t,)
        state : array_like, (n_states,) or (n_states, n_t), optional
            Internal states, name by name and each direction by direction; default 0.

        Returns
        -------
        float or ndarray
            Of the shape of ``v_rel``; 0 at v_rel = 0 for a law without states.
        """
        from fricmb.laws._numeric import force

        return force(self, v_rel, normal_force, state)

    @answers
    def rate(self, v_rel: ArrayLike, normal_force: ArrayLike, state: ArrayLike | None = None) -> Any:
        """Time derivative of the internal states; arguments as in :meth:`force`, shape like ``state``."""
        from fricmb.laws._numeric import rate

        return rate(self, v_rel, normal_force, state)

    @facade
    def _repr_html_(self) -> str:
        """Show it in a notebook."""

    # -- checks -------------------------------------------------------------------------------------------------
    def __post_init__(self) -> None:
        self.check()

    def check(self) -> None:
        """Bring the fields to their form and check them; raises :class:`LawError`."""
        kind: Any = type(self)
        if missing := no_fields(kind):
            raise LawError(
                f"{self._label()}: {', '.join(missing)} is no field; decorate the class with"
                " @dataclass(frozen=True, kw_only=True)"
            )
        check_said(self)
        for name in field_names(kind):
            value = getattr(self, name)
            if type(value) is not float or not isfinite(value):
                self._set(name, field_value(self, name))
        if self.kind == "coefficient" and not self.has_coefficient:
            raise LawError(f"{self._label()}: must define define_coefficient(self, r) or define_force(self, v, N, z)")
        if self.states and self.kind != "smooth":
            raise LawError(f"{self._label()}: a law with states must define define_force(self, v, N, z)")
        self._check_positive()
        if self.states:
            check_copies(self)
        numbers = self if self.only_numbers() else self.numeric()
        try:
            numbers.validate()
            if self.kind != "smooth":
                check_cone(numbers)
        except TypeError:
            # comparisons and formulas that take numbers alone
            for name in no_numbers(self):
                self._refuse(name, getattr(self, name), "a finite number")
            raise
