"""Friction-induced vibration with set-valued friction and located transitions.

Every public name is listed in ``__init__.pyi`` and loaded when it is first used.
"""

from typing import Any

import lazy_loader

_load, _, _names = lazy_loader.attach_stub(__name__, __file__)
__all__ = [*_names, "__version__"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            return version("fricmb")
        except PackageNotFoundError:
            return "0+unknown"
    try:
        return _load(name)
    except AttributeError:
        if name.startswith("_") or name in _names:
            raise
        from fricmb.errors import no_attribute

        raise no_attribute(__name__, name, __all__) from None


def __dir__() -> list[str]:
    return sorted(__all__)
