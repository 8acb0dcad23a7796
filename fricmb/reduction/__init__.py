"""From large structures to few modes: eigenproblems, residual flexibility, finite element meshes."""

from fricmb.reduction._matrices import displacement_rows, reduce_matrices
from fricmb.reduction._mesh import mesh_matrices
from fricmb.reduction._model import ReducedModel, reduce_model
from fricmb.reduction._modes import Reduced
from fricmb.reduction._pencil import lowest_modes
from fricmb.reduction._residual import Residual, flexibility, modal_residual, modes_to_keep

__all__ = [
    "Reduced",
    "ReducedModel",
    "Residual",
    "displacement_rows",
    "flexibility",
    "lowest_modes",
    "mesh_matrices",
    "modal_residual",
    "modes_to_keep",
    "reduce_matrices",
    "reduce_model",
]
