"""Signals that a run does not hold and the scene states: accelerations, and forces of elements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.field._functions import Given
from fricmb.field._motions import Moment
from fricmb.field._parts import Acts, Pushes
from fricmb.field._statements import Statements, frame_of
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.chunked_run import take
from fricmb.scene import Contact, Driven, Element, Force, Joint, MatrixElement, Scene

if TYPE_CHECKING:
    from fricmb.solution import Solution


def from_scene(sol: Solution, quantity: str, owner: str) -> Floats:
    """A signal at the times of a solution, out of the equations of its scene.

    Parameters
    ----------
    sol : Solution
    quantity : {"acceleration", "force", "elongation", "rate"}
    owner : str
        An element, whose components are (k, n_t) in the order of :func:`element_axes`.  For "acceleration" "" for all
        degrees of freedom (n, n_t), or a driven motion (n_t,).

    Raises
    ------
    SceneError
        Where a degree of freedom has no mass of its own.
    """
    samples, piece = sol.record.samples, sol.record.piece
    if piece is None:
        return _of_piece(sol, sol.run.pieces[0], samples, quantity, owner)
    parts = {k: _of_piece(sol, sol.run.pieces[k], take(samples, piece == k), quantity, owner) for k in np.unique(piece)}
    found = np.empty((*next(iter(parts.values())).shape[:-1], samples.t.size))
    for k, values in parts.items():
        found[..., piece == k] = values
    return found


def element_axes(sol: Solution) -> dict[str, tuple[str, ...]]:
    """Names of the components of the force of each element of the scene; none where the run is not one of a scene."""
    parts = sol.scene.parts if isinstance(sol.scene, Scene) else ()
    return {part.name: _axes(part) for part in parts if _has_force(part)}


def _has_force(part: Any) -> bool:
    return isinstance(part, Element) and not isinstance(part, Contact | Joint | MatrixElement)


def _axes(part: Any) -> tuple[str, ...]:
    """The axes of its motions where each has another, as of a spring between two points, else numbers."""
    if isinstance(part, Force):
        return ("1",)
    forms = part.local_coordinates()
    letters = tuple(form.terms[0][0].rpartition(".")[2] if form.terms else "" for form in forms)
    apart = len(set(letters)) == len(letters) and all(letters)
    return letters if apart else tuple(str(i + 1) for i in range(len(forms)))


def _of_piece(sol: Any, piece: Any, samples: Any, quantity: str, owner: str) -> Floats:
    if quantity == "acceleration":
        return _accelerations(sol, piece, samples) if not owner else _driven(sol, piece, samples, owner)
    frame = frame_of(sol.names, piece)
    part: Any = frame.scene[owner]
    moment = _moment(frame, samples, sol.names)
    if quantity in ("elongation", "rate"):
        found = [moment.form(form)[int(quantity == "rate")] for form in part.local_coordinates()]
    else:
        found = (Pushes(part) if isinstance(part, Force) else Acts(part)).forces(moment)
    return np.array([np.broadcast_to(np.asarray(x, dtype=float), samples.t.shape) for x in found])


def _moment(frame: Any, samples: Any, names: Any) -> Moment:
    """A moment for what asks for no reactions."""
    return Moment(
        frame=frame, t=samples.t, q=samples.q, v=samples.v, z=samples.z, F=samples.F * names.row_scale, N=samples.N,
        mode=samples.mode, lam={},
    )  # fmt: skip


def _driven(sol: Any, piece: Any, samples: Any, name: str) -> Floats:
    """Acceleration (n_t,) of a driven motion: the derivative of its formula."""
    frame = frame_of(sol.names, piece)
    owner, _, letter = name.rpartition(".")
    body: Any = frame.scene[owner]
    assert isinstance(body, Driven)
    given = Given(body.velocity[letter], order=1) if letter in body.velocity else Given(body.position[letter], order=2)
    return np.array(given.over(samples.t))


def _accelerations(sol: Any, piece: Any, samples: Any) -> Floats:
    """Accelerations (n, n_t) of all degrees of freedom: forces of all parts over the masses."""
    statements = Statements(sol, piece)
    force = statements.found(statements.moment(samples)).force
    if (statements.mass <= 0.0).any() and not statements.mass_matrices:
        bare = sol.dof_names[int(np.argmax(statements.mass <= 0.0))]
        raise SceneError(f"acceleration: {bare} has no mass of its own, its acceleration is not kept")
    if not statements.mass_matrices:
        found: Floats = force / statements.mass[:, None]
        return found
    return np.asarray(_mass_solver(statements)(force), dtype=float)


def _mass_solver(statements: Statements) -> Any:
    """What solves for accelerations, where some elements couple masses."""
    from scipy import sparse
    from scipy.sparse.linalg import splu

    M = sparse.lil_matrix(sparse.diags(statements.mass))
    for rows, own in statements.mass_matrices:
        M[np.ix_(rows, rows)] += sparse.csr_matrix(own).toarray()
    return splu(M.tocsc()).solve
