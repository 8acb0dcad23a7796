"""What every friction law states, and what every friction law can compute."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Literal, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb.errors import FricmbError, LawError
from fricmb.values import Declaration

Floats: TypeAlias = NDArray[np.float64]
LawKind: TypeAlias = Literal["constant", "coefficient", "smooth"]


@dataclass(frozen=True, kw_only=True)
class FrictionLaw(Declaration):
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

    #: Names of internal states; each stands for one state per tangential direction.
    states: ClassVar[tuple[str, ...]] = ()

    # -- what an author states ----------------------------------------------------------------------------------
    def define_coefficient(self, r: Any) -> Any:
        """mu(r) for slip speed r >= 0, in SymPy; ``(self, r, N)`` if it depends on the normal force too."""
        raise LawError(f"{type(self).__name__}: defines no coefficient")

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Force on the contact's a (a tuple, one for each direction), in SymPy.

        ``v``: relative velocity, one symbol for each tangential direction (1 or 2); ``N``: normal force; ``z``: states,
        name by name, each with one symbol for each direction.  A force that opposes slip has the sign of ``-v``.
        """
        raise LawError(f"{type(self).__name__}: defines no force")

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Time derivative of the states ``z`` (a tuple of the same length), in SymPy."""
        raise LawError(f"{type(self).__name__}: has the states {', '.join(self.states)} but defines no rate")

    def validate(self) -> None:
        """Check the numbers (named parameters are replaced by theirs); raises :class:`LawError`."""

    def compiled_coefficient(self) -> Callable[..., None] | None:
        """A compiled coefficient in place of a symbolic one, or None.

        For laws that SymPy cannot state (tables): a plain module-level function ``f(x, p, out)`` that numba can
        compile on pointers to float64, with ``x = [r, N]``, ``p`` = :meth:`parameter_block` and
        ``out = [mu, d mu/d r, d mu/d N]``.  Such a law overrides :meth:`coefficient` and :meth:`derivative` as well.
        """
        return None

    def parameter_block(self) -> Floats:
        """The numbers a compiled law reads, in order; by default all slots one after the other."""
        parts = [np.atleast_1d(np.asarray(value, dtype=float)) for value in self.numeric_slots().values()]
        return np.concatenate(parts) if parts else np.zeros(0)

    @classmethod
    def example(cls) -> Self:
        """A typical instance: each required field gets 0.5 unless a law knows better."""
        required = {f.name: 0.5 for f in fields(cls) if _required(f)}
        return cls(**required)

    # -- facts --------------------------------------------------------------------------------------------------
    @property
    def kind(self) -> LawKind:
        """``"constant"``, ``"coefficient"`` or ``"smooth"`` (a force law, which never sticks)."""
        return "smooth" if type(self).define_force is not FrictionLaw.define_force else "coefficient"

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

    def break_away(self, normal_force: float = 1.0) -> float:
        """Coefficient up to which the contact sticks."""
        mu_s = self.numeric_slots().get("mu_s")
        return self.slip_limit(normal_force) if mu_s is None else float(mu_s)

    # -- numbers ------------------------------------------------------------------------------------------------
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

    def derivative(self, r: ArrayLike, normal_force: ArrayLike = 1.0) -> Any:
        """Derivative of the coefficient with respect to the slip speed; arguments as in :meth:`coefficient`."""
        from fricmb.laws._numeric import derivative

        return derivative(self, r, normal_force)

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

    def rate(self, v_rel: ArrayLike, normal_force: ArrayLike, state: ArrayLike | None = None) -> Any:
        """Time derivative of the internal states; arguments as in :meth:`force`, shape like ``state``."""
        from fricmb.laws._numeric import rate

        return rate(self, v_rel, normal_force, state)

    def _repr_html_(self) -> str:
        from fricmb.plot._html import law_html

        return law_html(self)

    # -- checks -------------------------------------------------------------------------------------------------
    def __post_init__(self) -> None:
        self.check()

    def check(self) -> None:
        """Bring the fields to their form and check them; raises :class:`LawError`."""
        annotated = [n for n, a in vars(type(self)).get("__annotations__", {}).items() if "ClassVar" not in str(a)]
        if missing := set(annotated) - {f.name for f in fields(self)}:
            raise LawError(
                f"{self._label()}: {', '.join(sorted(missing))} is no field; decorate the class with"
                " @dataclass(frozen=True, kw_only=True)"
            )
        for field in fields(self):
            self._set(field.name, _field_value(self, field.name, field.type))
        if self.kind == "coefficient" and not self.has_coefficient:
            raise LawError(f"{self._label()}: must define define_coefficient(self, r) or define_force(self, v, N, z)")
        if self.states and self.kind != "smooth":
            raise LawError(f"{self._label()}: a law with states must define define_force(self, v, N, z)")
        self._check_positive()
        numbers = self.numeric()
        numbers.validate()
        if self.kind != "smooth":
            _check_cone(numbers)


def _required(field: Any) -> bool:
    from dataclasses import MISSING

    return field.default is MISSING and field.default_factory is MISSING


def _field_value(law: FrictionLaw, name: str, annotation: Any) -> Any:
    value = getattr(law, name)
    text = annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))
    if isinstance(value, list | tuple | np.ndarray) and np.ndim(value) == 1:
        return tuple(law._number(f"{name}[{i}]", entry) for i, entry in enumerate(value))
    if value is None or isinstance(value, bool):
        if text in ("float", "int"):
            law._refuse(name, value, "a finite number")
        return value
    if isinstance(value, str) and "float" not in text:
        return value
    return law._number(name, value)


def _check_cone(law: FrictionLaw) -> None:
    limit, mu_s = law.slip_limit(), law.break_away()
    if not np.isfinite(limit):
        raise LawError(f"{law._label()}: the coefficient must be finite at r = 0, got {limit!r}")
    if limit < 0.0:
        raise LawError(f"{law._label()}: the coefficient must be >= 0 at r = 0, got {limit!r}")
    if mu_s < limit * (1.0 - 1e-12):
        raise LawError(
            f"{law._label()}: mu_s must be at least the coefficient of slip for r -> 0 ({limit:g}), got {mu_s!r}"
        )
