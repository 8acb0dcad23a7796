"""Numbers out of what a law states: SymPy expressions turned into numpy functions, one set per class and shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import reduce
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb.errors import LawError
from fricmb.integrate.signals.pieces import series_value
from fricmb.laws._without_sympy import alike, numbers_of
from fricmb.values import Declaration, Symbolic, ask, expressions, held, one_expression, symbolic

_Functions = dict[tuple[Any, ...], Callable[..., Any]]
_functions: WeakKeyDictionary[type, _Functions] = WeakKeyDictionary()
#: Slip speeds to fall back to where an intermediate result overflows (inf * 0): the value has long settled there.
_LADDER = (1e100, 1e50, 1e25, 1e12, 1e6, 1e3, 1e1)
#: Slip speed that stands for r = 0 where a formula is singular there.
_SMALL = 1e-150


def coefficient_expression(law: Any, stand: Symbolic) -> tuple[Any, Any, Any]:
    """Symbols r and N, and mu of them."""
    import sympy

    r, N = sympy.Symbol("|v|", nonnegative=True), sympy.Symbol("N[]", nonnegative=True)
    given = {"r": r, "N": N} if law.load_dependent else {"r": r}
    said = LawError, law._label(), "define_coefficient"
    mu = ask(*said, stand.standin.define_coefficient, **given)
    # a law inside may depend on the load where its own does not say so
    return r, N, one_expression(*said, mu, {r, N, *stand.flat})


def force_expression(law: Any, stand: Symbolic, d: int) -> tuple[Any, Any, Any, Any, Any]:
    """Symbols v, N, z, and force and rate of them, in ``d`` directions."""
    import sympy

    v = tuple(sympy.Symbol(f"v[{i}]", real=True) for i in range(d))
    z = tuple(sympy.Symbol(f"z[{i}]", real=True) for i in range(law.n_states(d)))
    N = sympy.Symbol("N[]", nonnegative=True)
    given, known = {"v": v, "N": N, "z": z}, {*v, N, *z, *stand.flat}
    said, what = (LawError, law._label()), "expressions for this contact"
    pull = ask(*said, "define_force", stand.standin.define_force, **given)
    force = expressions(*said, "define_force", pull, d, known, what)
    if not z:
        return v, N, z, force, ()
    change = ask(*said, "define_rate", stand.standin.define_rate, **given)
    return v, N, z, force, expressions(*said, "define_rate", change, len(z), known, what)


def _shape(law: Any) -> tuple[Any, ...]:
    """What selects the formulas beside the type: options, lengths of tuples, and the same of a law inside."""
    options = tuple((name, held(value)) for name, value in law.options().items())
    shapes = tuple((path, np.shape(value)) for path, value in law.numeric_slots().items())
    inner = [getattr(law, field.name) for field in fields(law)]
    return options, shapes, *((type(i), _shape(i)) for i in inner if isinstance(i, Declaration))


def _make(law: Any, what: str, d: int) -> Callable[..., Any]:
    import sympy

    stand = symbolic(law)
    if what in ("coefficient", "derivative"):
        r, N, mu = coefficient_expression(law, stand)
        expression = mu if what == "coefficient" else sympy.diff(mu, r)
        _only_known(law, (mu,))
        return sympy.lambdify([r, N, *stand.flat], expression, _MODULES)  # type: ignore[no-any-return]
    v, N, z, force_, rate_ = force_expression(law, stand, d)
    chosen = force_ if what == "force" else rate_
    arguments = [*v, N, *z, *stand.flat]
    _only_known(law, chosen)
    return sympy.lambdify(arguments, [_lengths(e) for e in chosen], _MODULES)  # type: ignore[no-any-return]


def _only_known(law: Any, stated: tuple[Any, ...]) -> None:
    """Refuse functions that nobody has defined."""
    from sympy.core.function import AppliedUndef

    for expression in stated:
        for call in sorted(expression.atoms(AppliedUndef), key=str):
            if type(call).__name__ not in _MODULES[0]:
                raise LawError(f"{law._label()}: the function {call} is not known; write it in functions of SymPy")


def _lengths(expression: Any, length: Any = None) -> Any:
    """Guarded roots of sums of squares as a function that neither overflows nor underflows.

    ``length``: that function, where it is more than a name.
    """
    import sympy

    length = length or sympy.Function("vector_length", positive=True)

    def replaced(node: Any) -> Any:
        parts = squares(node.base)
        return node if parts is None else length(*parts) ** (2 * node.exp)

    return sympy.sympify(expression).replace(lambda node: node.is_Pow and squares(node.base) is not None, replaced)


def squares(radicand: Any) -> list[Any] | None:
    """The components of a guarded sum of squares (see ``norm``), or None for any other expression."""
    if not radicand.is_Add:
        return None
    guard = [term for term in radicand.args if term.is_Float and 0 < term < 1e-150]
    rest = [term for term in radicand.args if term not in guard]
    if not guard or not all(term.is_Pow and term.exp == 2 for term in rest):
        return None
    return [term.base for term in rest]


def _length(*components: Any) -> Any:
    value = np.abs(components[0])
    for component in components[1:]:
        value = np.hypot(value, component)
    return np.maximum(value, 1e-100)


def _largest(values: Any, axis: int = 0) -> Any:
    return reduce(np.maximum, values)


def _least(values: Any, axis: int = 0) -> Any:
    return reduce(np.minimum, values)


#: Functions of the numpy code; Max and Min take numbers beside arrays.
_MODULES = [{"vector_length": _length, "amax": _largest, "amin": _least, "Series": series_value}, "numpy"]


def _function(law: Any, what: str, d: int = 0) -> Callable[..., Any]:
    made = _functions.setdefault(type(law), {})
    key = (what, d, *_shape(law))
    if key not in made:
        made[key] = _make(law, what, d)
    return made[key]


def _evaluate(law: Any, what: str, r: ArrayLike, normal_force: ArrayLike) -> Any:
    r_, N_ = alike(law, "r", numbers_of(law, "r", r), numbers_of(law, "normal_force", normal_force))
    if np.any(r_ < 0.0) or np.any(np.isnan(r_)):
        raise LawError(f"{law._label()}: slip speed r must be >= 0, got {float(np.min(r_))!r}")
    function, p = _function(law, what), law.parameter_block()
    with np.errstate(all="ignore"):
        value = _array(function(r_, N_, *p), r_.shape)
        for fallback in (_SMALL, *_LADDER):
            bad = ~np.isfinite(value)
            if not np.any(bad):
                break
            near = bad & ((r_ < _SMALL) if fallback == _SMALL else (r_ > fallback))
            if np.any(near):
                value[near] = _array(function(np.full(r_.shape, fallback), N_, *p), r_.shape)[near]
    return value if value.ndim else float(value)


def _array(value: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    return np.array(np.broadcast_to(np.asarray(value, dtype=float), shape))


def coefficient(law: Any, r: ArrayLike, normal_force: ArrayLike) -> Any:
    """mu(r); of a force law that states none, its force per unit normal force in steady sliding."""
    if law.has_coefficient:
        return _evaluate(law, "coefficient", r, normal_force)
    if law.states:
        raise LawError(f"{law._label()}: has internal states and states no coefficient; use force()")
    speed, N = alike(law, "r", numbers_of(law, "r", r), numbers_of(law, "normal_force", normal_force))
    value = -force(law, speed.reshape(1, -1), N.ravel(), None).reshape(speed.shape) / N
    return value if value.ndim else float(value)


def derivative(law: Any, r: ArrayLike, normal_force: ArrayLike) -> Any:
    """Slope of mu(r)."""
    if law.has_coefficient:
        return _evaluate(law, "derivative", r, normal_force)
    speed = numbers_of(law, "r", r)
    step = 1e-6 * np.maximum(1.0, speed)
    low, high = np.maximum(speed - step, 0.0), speed + step
    difference = coefficient(law, high, normal_force) - coefficient(law, low, normal_force)
    value = np.asarray(difference / (high - low))
    return value if value.ndim else float(value)


def _columns(law: Any, v_rel: ArrayLike, normal_force: ArrayLike, state: ArrayLike | None) -> tuple[Any, ...]:
    """Velocity (d, n_t), normal force (n_t,), state (n_z, n_t) and the shape to return."""
    v = numbers_of(law, "v_rel", v_rel)
    columns = np.atleast_1d(v).reshape(max(1, v.shape[0] if v.ndim else 1), -1)
    d = columns.shape[0]
    known = (*law.dimensions, *((3,) if law.cone_in_space else ()))
    if v.ndim > 2 or v.size == 0 or d not in known:
        accepted = f"a number, (d,) or (d, n_t) with d = {' or '.join(map(str, known))}"
        raise LawError(f"{law._label()}: v_rel must be {accepted}, got shape {v.shape}")
    N = numbers_of(law, "normal_force", normal_force)
    if N.shape not in ((), (1,), columns.shape[1:]):
        raise LawError(f"{law._label()}: normal_force must be a number or have shape (n_t,), got shape {N.shape}")
    N = np.broadcast_to(N, columns.shape[1:])
    n_z = law.n_states(d)
    z = np.zeros((n_z, columns.shape[1]))
    if state is not None:
        given = numbers_of(law, "state", state)
        if given.size not in (n_z, z.size) or (given.ndim > 0 and n_z > 0 and given.shape[0] not in (n_z, z.shape[1])):
            raise LawError(f"{law._label()}: state must have shape ({n_z},) or ({n_z}, n_t), got {given.shape}")
        z[:] = given.reshape(n_z, -1) if n_z else 0.0
    return columns, N, z, v.shape


def force(law: Any, v_rel: ArrayLike, normal_force: ArrayLike, state: ArrayLike | None) -> Any:
    """Force on the contact's a."""
    v, N, z, shape = _columns(law, v_rel, normal_force, state)
    if law.kind == "smooth":
        value = _smooth(law, "force", v, N, z)
    else:
        r = np.abs(v).max(axis=0)
        scale = np.array(law.numeric().axis_scale() or (1.0,) * len(v), dtype=float)[:, None]
        r = _length(*(scale * v)) * (r > 0.0)
        direction = scale * np.divide(scale * v, r, out=np.zeros_like(v), where=r > 0.0)
        value = -law.coefficient(r, N) * N * direction
    value = value.reshape(shape)
    return value if value.ndim else float(value)


def rate(law: Any, v_rel: ArrayLike, normal_force: ArrayLike, state: ArrayLike | None) -> Any:
    """Rate of the states; an empty array for a law without states."""
    v, N, z, shape = _columns(law, v_rel, normal_force, state)
    if not law.states:
        return np.zeros((0, *shape[1:]))
    value = _smooth(law, "rate", v, N, z)
    return value.reshape(len(z), *shape[1:]) if len(shape) else value.ravel()


#: Components of velocity beyond this are cut in laws that are forces: no product of them overflows.
FASTEST = 1e20


def _smooth(law: Any, what: str, v: NDArray[np.float64], N: Any, z: Any) -> NDArray[np.float64]:
    """Force or rate of a law that is a force; where it overflows, that at the fastest speed."""
    if law.compiled_force(v.shape[0]) is not None:
        return _called(law, what, v, N, z)
    function, p = _function(law, what, v.shape[0]), law.parameter_block()
    with np.errstate(all="ignore"):
        value = np.array([_array(row, N.shape) for row in function(*v, N, *z, *p)])
        bad = ~np.isfinite(value)
        if np.any(bad):
            rows = function(*np.clip(v, -FASTEST, FASTEST), N, *z, *p)
            value[bad] = np.array([_array(row, N.shape) for row in rows])[bad]
    return value


def _called(law: Any, what: str, v: NDArray[np.float64], N: Any, z: Any) -> NDArray[np.float64]:
    """A law that brings its own compiled force, called column by column."""
    d, n_z = v.shape[0], z.shape[0]
    function, p = law.compiled_force(d), law.parameter_block()
    rows = np.zeros((d + n_z, v.shape[1]))
    out = np.zeros((d + n_z) * (d + n_z + 2))
    for j in range(v.shape[1]):
        function(np.array([*v[:, j], N[j], *z[:, j]]), p, out)
        rows[:, j] = out[: d + n_z]
    return rows[:d] if what == "force" else rows[d:]
