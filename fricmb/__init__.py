"""Friction-induced vibration with set-valued friction and located transitions.

Every public name is listed in ``__init__.pyi`` and loaded when it is first used.
"""

import os.path
from typing import Any

import lazy_loader

# In a checkout the models stand beside this folder: they are found where the working folder comes before what is
# installed, as with `python -c` and `python -m pytest` in the root of a clone.
_root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
if not os.path.isdir(os.path.join(_root, "fricmb", "models")) and os.path.isfile(os.path.join(_root, "pyproject.toml")):
    __path__.append(_root)

_load, _, _names = lazy_loader.attach_stub(__name__, __file__)
__all__ = [*_names, "__version__"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from fricmb._version import installed_version

        return installed_version()
    try:
        return _load(name)
    except AttributeError:
        if name.startswith("_") or name in _names:
            raise
        from fricmb.errors import no_attribute

        raise no_attribute(__name__, name, __all__) from None


def __dir__() -> list[str]:
    return sorted(__all__)
