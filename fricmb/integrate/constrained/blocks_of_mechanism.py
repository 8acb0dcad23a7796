"""Blocks that evaluating and running a mechanism takes."""

from __future__ import annotations

from fricmb.integrate.compile.lapack import load_lapack
from fricmb.integrate.compile.parallel_compile import load_blocks

#: Of evaluations and steps by stages.
BLOCKS = (
    "move", "forces", "call_joint", "add_extended", "add_form", "add_column", "add_row", "add_stiffness",
    "add_pairs", "add_joints", "add_structure", "add_contacts", "add_slip", "add_load", "add_friction",
    "friction_residual", "instant_residual", "instant_matrix", "react", "powers", "linearise", "factor_stages",
    "stage_residual", "newton_change", "friction_alone", "iterate_stages", "try_step", "project_positions",
    "project_velocities",
    "end_step", "decide", "enumerate_modes", "margins", "change_modes", "violated", "record_step",
    "copy_state", "radau_step", "lightness", "add_stick", "weigh_ports", "laws_between", "load_defect",
    "unseen_force", "jump_error", "share_load", "start_group", "solve_by_series", "put_path",
    "add_forces", "react_at_rows", "stop_rows", "release_in_turn", "release_in_plane",
)  # fmt: skip


def load_mechanism(*further: str) -> None:
    """Load them, and ``further`` blocks, whose modules are imported."""
    from fricmb.integrate.constrained import time_loop  # noqa: F401  (its import makes the blocks known)

    load_lapack()
    load_blocks(*BLOCKS, *further)
