"""Whether kernels are compiled by numba's own passes, or by quicker ones that rest on numba's insides.

The quick ones (:mod:`fricmb.integrate.compile.fast`) halve the time of compiling; results are the same.  They are left
out where ``FRICMB_PLAIN=1`` stands in the environment, and where they do not work with the numba that is installed:
before the first compilation of a process a small kernel is compiled by them and compared.
"""

from __future__ import annotations

import dis
import os
import threading
from functools import cache
from types import CodeType
from typing import Any

from fricmb.integrate.compile.cache_files import say

_lock = threading.RLock()
_plain = os.environ.get("FRICMB_PLAIN", "") not in ("", "0")
#: Whether it is known that the quick passes work, or that they are not to be used.
_settled = _plain


def is_plain() -> bool:
    """Whether kernels are compiled by numba's own passes, as far as it is known."""
    return _plain


def settle() -> bool:
    """Find out whether the quick passes work, if nobody knows yet; whether that has changed :func:`is_plain`."""
    global _plain, _settled
    with _lock:
        if _settled:
            return False
        _settled = True
        try:
            from fricmb.integrate.compile.fast.trial import try_out

            try_out()
        except Exception as error:  # whatever a numba of other insides can bring about
            _plain = True
            import numba

            said = (str(error).strip() or type(error).__name__).splitlines()[0]
            say(
                f"kernels are compiled by numba's own passes, in about twice the time: fricmb's do not work with numba "
                f"{numba.__version__} ({type(error).__name__}: {said})"
            )
        return _plain


def quick_passes() -> Any:
    """The module of the quick passes, None where numba's own are taken."""
    settle()
    if _plain:
        return None
    from fricmb.integrate.compile.fast import passes

    return passes


def names_taken(code: CodeType) -> set[str]:
    """Names that a code takes from its module; an attribute may have the name of something there and be another."""
    found: set[str] = _names_reader()(code)
    return found


@cache
def _names_reader() -> Any:
    """What reads names: from the bytes of the code if that agrees with :mod:`dis`, whose own is ten times as long."""
    if _plain:
        return _names_by_dis
    try:
        from fricmb.integrate.compile.fast.names_taken import names_taken as quick

        # a code with more names than fit into one byte, so that some take two instructions
        text = "".join(f"name_{i}(other.name_{i + 1}); " for i in range(200))
        code = compile(f"def sample(other): {text}", "sample", "exec").co_consts[0]
        return quick if quick(code) == _names_by_dis(code) else _names_by_dis
    except Exception:  # bytes of another Python
        return _names_by_dis


def _names_by_dis(code: CodeType) -> set[str]:
    return {step.argval for step in dis.get_instructions(code) if step.opname in ("LOAD_GLOBAL", "LOAD_NAME")}
