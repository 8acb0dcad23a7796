"""Small scenes keep BLAS to one thread while they run, and leave the setting as they found it."""

import pytest
import scipy.linalg
from threadpoolctl import threadpool_info, threadpool_limits

import fricmb as fm
from fricmb._simulate._blas import MANY, blas_threads


def threads():
    assert scipy.linalg.lapack  # loaded, so that it counts
    return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]


@pytest.fixture
def two():
    with threadpool_limits(2, user_api="blas"):
        counts = threads()
        if set(counts) != {2}:
            pytest.skip(f"BLAS has {counts} threads here, whatever is asked for")
        yield counts


def test_a_run_has_one_thread_and_gives_the_others_back(two):
    seen = []
    fm.simulate(fm.models.belt_oscillator(), t_end=5.0, on_chunk=lambda part: seen.append(threads()), chunk=2.0)
    assert threads() == two
    assert seen
    assert all(count == 1 for counts in seen for count in counts)


def test_an_error_gives_them_back(two):
    with pytest.raises(fm.SceneError):
        fm.simulate(fm.models.belt_oscillator(), t_end=-1.0)
    assert threads() == two


def test_large_scenes_keep_them(two):
    with blas_threads(fm.models.brake4dof()):
        assert set(threads()) == {1}
    with blas_threads(fm.models.stick_slip_chain(MANY + 1)):
        assert threads() == two
