"""The result of a run."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb._calls import answers
from fricmb._facade import facade
from fricmb.errors import unknown_name
from fricmb.integrate import Samples
from fricmb.integrate.problem import Codes, Floats
from fricmb.solution._derivatives import Derivatives
from fricmb.solution._energy import Reference
from fricmb.solution._events import Events
from fricmb.solution._impacts import Impulses, impulses
from fricmb.solution._names import Names
from fricmb.solution._run import Record
from fricmb.solution._signals import Signals
from fricmb.solution._stats import Stats
from fricmb.solution._stored import Stored
from fricmb.solution._summary import describe, summarise
from fricmb.values import Units

if TYPE_CHECKING:
    import pandas

    from fricmb.audit import Audit
    from fricmb.field import Touches
    from fricmb.plot import SolutionPlots


class Solution(Signals):
    """Result of a run: motion, contacts, transitions, energies, and what it cost.

    Made by :func:`fricmb.simulate`.  Time is the last axis of every array; units are those of the scene.

    Parameters
    ----------
    names : Names
    run : Run
    stats : Stats
    events : Events, optional
        Default: the transitions of the run.
    times : (n_t,), optional
        Times of the solution; default: the accepted steps, a transition's time twice (before and after).
    """

    @answers
    def at(self, t: Any) -> Solution:
        """The same run seen at other times (in the order given); the right-hand value at a transition.

        Raises SceneError for a time outside the run.
        """
        run = self.run
        other = Solution(names=self.names, run=run, stats=self.stats, events=self.events, times=run.inside(t))
        if "_reference" in self.__dict__:
            other.__dict__["_reference"] = self._reference
        other._units = self._units
        other._asked, other.asked_events = self._asked, self.asked_events
        return other

    @property
    @facade
    def plot(self) -> SolutionPlots:
        """Pictures: ``sol.plot.velocities()``, ..."""

    def animate(self, path: str | PathLike[str] | None = None, **options: Any) -> Any:
        """The run as moving pictures, or in a browser with a time slider; options of ``sol.plot.animation``.

        ``sol.animate("run.html")`` writes the interactive view, ".gif" and ".mp4" moving pictures.
        """
        return self.plot.animation(path, **options)

    @facade
    def audit(self, *, rtol: float | None = None, atol: Any = None, seed: int = 0) -> Audit:
        """Check the run against the equations of its scene, on a path that shares nothing with the compiled kernels.

        What every part states in SymPy is evaluated by numpy at random times of the dense output: equations of motion
        and of law states in integrated form, laws and cones of friction, creep in stick, constraints, transitions,
        energy.  Each residual is given in units of what the tolerance allows there.

        Parameters
        ----------
        rtol : float, optional
            Tolerance that residuals are measured by; default: that of the run, 1e-3 for fixed steps.
        atol : float or (n_dof,) or (2 n_dof,), optional
            Errors that never matter; default: as in the run.
        seed : int
            Of the random times.

        Returns
        -------
        fricmb.audit.Audit
            ``.ok``, ``.checks``, ``.table()``; printed, three lines.
        """

    def impulse(self, name: str) -> Impulses:
        """Impulses of a part with ``restitution=``.

        Parameters
        ----------
        name : str

        Returns
        -------
        Impulses
            ``.t``, ``.normal``, ``.tangential`` (n,), and ``.side``; ``len`` counts them.

        Raises
        ------
        UnknownNameError
            For the name of another part; lists those near.
        """
        return impulses(self.events, name, tuple(joint.name for joint in self.scene.joints if joint.is_rigid))

    @facade
    def touches(self, name: str) -> Touches:
        """Times at which a :class:`Stop` or the flanks of a :class:`Backlash` pushed.

        Parameters
        ----------
        name : str

        Returns
        -------
        Touches
            Times ``.begin`` and ``.end`` (n,), and ``.side``, "lower" or "upper" for each; ``len`` counts them.

        Raises
        ------
        SceneError
            For the name of another part, or of one with restitution (see :meth:`impulse`).
        """

    @answers
    def tensions(self, name: str) -> Floats:
        """Tensions (2, n_t) of a :class:`Rope` at its drum: on the first and on the second side, >= 0.

        Parameters
        ----------
        name : str

        Raises
        ------
        UnknownNameError
            For the name of another part; lists the ropes.
        """
        ropes = [joint.name for joint in self.scene.joints if joint.has_tensions]
        if not isinstance(name, str) or name not in ropes:
            raise unknown_name("rope", name, ropes)
        mean, difference = self.reaction(name)[0], self.force(name)[0]
        return np.array([mean + difference / 2, mean - difference / 2])

    @answers
    def columns(self, names: Iterable[str] | None = None) -> dict[str, Floats | Codes]:
        """Signals (n_t,) by name, as in :meth:`to_pandas`.

        Parameters
        ----------
        names : names, optional
            Those wanted, as in ``sol[name]``; default: positions, velocities, and what the run holds of contacts.
        """
        from fricmb.solution._table import columns

        return columns(self, names)

    @answers
    def to_pandas(self, names: Iterable[str] | None = None) -> pandas.DataFrame:
        """Signals as a table over time; needs pandas.  ``names``: as :meth:`columns`."""
        from fricmb.solution._table import table

        return table(self, names)

    @answers
    def export(self, path: str | PathLike[str], names: Iterable[str] | None = None) -> Path:
        """Write signals for other programs: ".mat" (MATLAB), ".h5" or ".hdf5" (needs h5py), ".csv"; returns the path.

        Files other than ".csv" hold the transitions as well.  In MATLAB a name has underscores for its dots: ``pad_x``.

        Parameters
        ----------
        path : path
        names : names, optional
            As :meth:`columns`.
        """
        from fricmb.solution._export import export

        return export(self, path, names)

    @answers
    def save(self, path: str | PathLike[str]) -> None:
        """Write everything to an npz file, ".npz" being added if there is no suffix."""
        from fricmb.solution._files import save

        save(self, path)

    @staticmethod
    def load(path: str | PathLike[str], *, laws: Any = ()) -> Solution:
        """Load a run from a file that :meth:`save` wrote.

        Nothing in a file is executed: arrays, names, events and energies are numpy arrays, scene and dense output
        (``sol(t)``, ``sol.at``) are data, opened when one of them is first asked for.  What belongs to fricmb is found
        by its name; own laws and elements are found where their module has been imported already.

        Parameters
        ----------
        path : path
        laws : class, iterable of classes, dict of name to class, or "import"
            Own laws and elements that the file refers to; "import": import the modules that the file names, which runs
            their code.  Without them the arrays can be read all the same.

        Raises
        ------
        FricmbError
            For a file that is damaged, inconsistent, or no solution; names file and entry.
        """
        from fricmb.solution._files import load

        return load(path, laws)

    @staticmethod
    def join(solutions: Iterable[Solution]) -> Solution:
        """Join runs that continue one another into one; see :func:`fricmb.simulate`, ``initial=``."""
        from fricmb.solution._join import join

        return join(solutions)

    def summary(self) -> str:
        """What happened, on a few lines."""
        return summarise(self)

    @facade
    def _repr_html_(self) -> str:
        """Show it in a notebook."""

    def __repr__(self) -> str:
        return describe(self)


def restore(
    *,
    names: Names,
    stats: Stats,
    events: Events,
    record: Record[Samples],
    span: tuple[float, float],
    has_rows: bool,
    energies: tuple[Floats, Floats],
    reference: Reference,
    run: Stored,
    units: Units,
    derivatives: Derivatives | None = None,
) -> Solution:
    """A solution from what a file holds; ``run`` is left closed until it is needed."""
    sol = Solution.__new__(Solution)
    sol._asked, sol._derivatives, sol._look_for, sol.asked_events = (), None, None, ()
    sol.names, sol.stats, sol.record, sol.has_rows = names, stats, record, has_rows
    sol._events, sol._span, sol._energies, sol._run = events, span, energies, run
    sol._units = units
    sol.__dict__["_reference"] = reference
    if derivatives is not None:
        sol.take_derivatives(derivatives)
    return sol
