"""Blocks that a run of a scene without joints takes: others are neither compiled nor read."""

from __future__ import annotations

from fricmb.integrate.compile.lapack import load_lapack
from fricmb.integrate.compile.parallel_compile import load_blocks
from fricmb.integrate.model.problem_structs import packed_of
from fricmb.integrate.problem import Problem
from fricmb.integrate.step import band_matrix
from fricmb.integrate.step.bends_without_joints import bend_ahead

#: Whatever the steps are.
CORE = (
    "complete", "settle", "mark_rest", "find_open", "find_changing_contact", "locate", "transition", "advance",
)  # fmt: skip
#: Of steps whose stages are solved for all velocities.
STAGES = ("general_ports", "solve_stages", "radau_attempt", "radau_error", "radau_finish", "record_stages")
#: By how the matrices of the structure are kept.
DENSE = "factorise_dense", "correct_dense"
BAND = band_matrix.factorise_band.__name__, band_matrix.correct_band.__name__


def load_core(*further: str) -> None:
    """Load what every run takes, and ``further`` blocks, whose modules are imported."""
    load_lapack()
    load_blocks(*further, *CORE)


def load_stages(problem: Problem, *further: str) -> None:
    """Load the blocks of steps by stages."""
    storage = DENSE if packed_of(problem).structure.half < 0 else BAND
    load_core(*STAGES, *storage, *where_it_bends(problem), *further)


def where_it_bends(problem: Problem) -> tuple[str, ...]:
    """What a run takes where laws or elements bend."""
    laws = ("next_knot", "off_beside_knots") if problem.contacts.knots.size else ()
    elements = (bend_ahead.__name__,) if problem.bends.table.address.size else ()
    return laws + elements
