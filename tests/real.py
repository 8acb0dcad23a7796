"""Measured and computed files of other people, which stand beside the repository where somebody has put them."""

from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[1]
_PLACES = [_ROOT.parent / "shared" / "real", _ROOT.parents[1] / "shared" / "real"]
_FOLDER = next((place for place in _PLACES if place.is_dir()), None)

needs_real = pytest.mark.skipif(_FOLDER is None, reason="no folder of real files beside the repository")


def real(name):
    """The path of a file there."""
    return _FOLDER / name
