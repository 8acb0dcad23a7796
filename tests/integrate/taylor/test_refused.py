"""What Taylor steps leave to others, by name."""

import pytest

import fricmb as fm


def test_bodies_that_turn_are_refused():
    rod = fm.models.dry_pendulum()
    with pytest.raises(fm.FricmbError, match="bodies that turn, or joints"):
        fm.simulate(rod, t_end=1.0, method="taylor")
