"""Measured and computed files of other people, which stand beside the repository where somebody has put them."""

from pathlib import Path

import pytest

import fricmb as fm

_ROOT = Path(__file__).parents[1]
_PLACES = [_ROOT.parent / "shared" / "real", _ROOT.parents[1] / "shared" / "real"]
_FOLDER = next((place for place in _PLACES if place.is_dir()), None)

needs_real = pytest.mark.skipif(_FOLDER is None, reason="no folder of real files beside the repository")


def real(name):
    """The path of a file there."""
    return _FOLDER / name


#: Eigenvalues of the industrial brake that grow, of all its 4669 degrees of freedom.
GROWING = [24.3627793706 + 36438.3081016515j, 60.4222361512 + 17475.7803361094j, 78.6599917371 + 26347.7200049144j]


def industrial_brake():
    """The brake reduced, its friction by the parameter kappa."""
    names = {"M": "BMLL", "K": "BKLL", "C": "BDLL", "H": "BHLL", "KR": "BKQLL", "DG": "BYLL"}
    fe = fm.fe.read(real("brake_5koref1.npz"), names=names, units="t-mm-s")
    kappa = fm.parameter("kappa", 1.0)
    body = fm.ModalBody.from_fe(
        "brake", fe, points={"p": [0, 1, 2]}, up_to=8000, scales={"KR": kappa, "DG": 1.0},
        enrich=[{"kappa": 0.5}, {"kappa": 1.0}], structural_at=1600,
    )  # fmt: skip
    return fm.Scene("brake", [body, body.matrix("KR", K="KR", scale=kappa), body.matrix("DG", C="DG")])
