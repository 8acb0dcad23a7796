"""A run that is cut within a step ends at the cut: its last row is there."""

import numpy as np

import fricmb as fm
from fricmb.solution import Piece


def test_the_cut_is_a_row():
    sol = fm.simulate(fm.models.belt_oscillator(), t_end=30.0)
    whole = sol.run.pieces[0]
    i = int(np.argmax(np.diff(sol.t)))
    middle = 0.5 * (sol.t[i] + sol.t[i + 1])
    piece = Piece(whole.trajectory, whole.origin, whole.mechanics, middle)
    for rows in (piece.rows(), piece.row_motion()):
        np.testing.assert_array_equal(rows.t, [*sol.t[: i + 1], middle])
        np.testing.assert_allclose(rows.q[:, -1], sol.at(middle).q[:, 0], rtol=1e-14)
    at_a_row = Piece(whole.trajectory, whole.origin, whole.mechanics, float(sol.t[i]))
    np.testing.assert_array_equal(at_a_row.rows().t, sol.t[: i + 1])
