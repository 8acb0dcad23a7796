"""From a scene to a solution."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from fricmb._calls import answers

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fricmb._simulate._arguments import Span
    from fricmb.integrate import Integrator, Trajectory
    from fricmb.scene import Scene
    from fricmb.solution import LooksFor, Solution


@answers
def simulate(
    scene: Scene,
    *,
    t_end: float,
    t_start: float = 0.0,
    rtol: float = 1e-6,
    atol: ArrayLike | None = None,
    t_eval: ArrayLike | None = None,
    method: str | Integrator = "auto",
    parameters: Mapping[str, Any] | None = None,
    initial: Solution | Mapping[str, Mapping[str, Any]] | None = None,
    observe: Iterable[str] | None = None,
    step: float | None = None,
    max_step: float | None = None,
    events: Mapping[str, Any] | None = None,
    terminal: str | Iterable[str] = (),
    progress: bool = False,
    dense: bool | None = None,
    chunk: float | None = None,
    on_chunk: Callable[[Solution], object] | None = None,
    time_limit: float | None = None,
    sensitivities: str | Iterable[str] | None = None,
) -> Solution:
    """Simulate a scene.

    Parameters
    ----------
    scene : Scene
    t_end : float
        End of the run, after ``t_start``.
    t_start : float
        Start; a run that goes on from another (``initial``) starts at that one's end.
    rtol : float
        Error of each signal relative to its largest magnitude so far, 1e-14 to 0.1.
    atol : float or array, optional
        Magnitude of error that never matters: a number, one for each degree of freedom, or positions then velocities.
        Default: chosen from rtol and each signal's scale.
    t_eval : (n_t,), optional
        Times of the solution, in rising order.  Default: the accepted steps.
    method : str or Integrator
        "auto", a name out of ``fricmb.integrators``, or a configured instance of one.
    parameters : dict, optional
        Values by the names of ``scene.parameters``, for this run.
    initial : Solution or dict, optional
        A solution to go on from, with its positions, velocities, law states, contact modes, driven positions and time;
        or ``{"position": {"pad.x": 1.0}, "velocity": {...}, "state": {"lining": z}}`` in place of what the scene says.
    observe : names, optional
        Degrees of freedom, points and contacts of interest: parts that cannot influence them may be left out.
    step : float, optional
        Step of a method with fixed steps.
    max_step : float, optional
        Longest step of a method that chooses its own; default: as long as the motion and the functions of time in the
        scene allow.
    events : dict, optional
        Expressions by name, whose changes of sign are located and stand in ``sol.events`` with the kind "event":
        ``{"passes": fm.coordinate("mass.x") - 0.5}``, in ``fm.t``, ``fm.coordinate``, ``fm.speed`` and parameters, or a
        signal of the solution and a number, ``("sole.force", 2.0)``.  A value that only touches 0 within errors does
        not change sign.
    terminal : names, optional
        Names out of ``events``: the run ends at the first of them.
    progress : bool
        Show a bar on the terminal.
    dense : bool, optional
        Whether to keep the motion between the times of the solution (``sol(t)``, ``sol.at``).  Default: yes, unless
        ``t_eval`` is given and the run is so long that this would take more than some 60 megabytes.
    chunk : float, optional
        Time from one call of ``on_chunk`` to the next; default: a hundredth of the run.
    on_chunk : callable, optional
        Called with a Solution of each part of the run, to be written to disk, say; its energies count from that part's
        start.  Nothing of it is kept: memory does not grow with the length of the run.
    time_limit : float, optional
        Seconds of wall time, from the call on, after which the run ends with an IntegrationError that holds what was
        computed.  Compiling, which happens once on a machine, counts but is not cut short.
    sensitivities : names or "state", optional
        Parameters, as in ``scene.parameters``, with respect to which the run is differentiated, initial values included
        (``"rotor.velocity.x"``: the value that the run starts with); "state", alone or among the names: all initial
        values.  See :meth:`Solution.sensitivity`, :attr:`Solution.monodromy`, ``sol.events[i].sensitivity(name)``.

    Returns
    -------
    Solution
        With ``on_chunk`` that of the last part.

    Raises
    ------
    SceneError
        For an argument that is not accepted; names the argument, the value and what is accepted.
    IntegrationError
        For a run that could not go on, or took longer than ``time_limit`` or more memory than there is; ``partial`` is
        the solution up to there.
    Interrupted
        After Ctrl-C (a KeyboardInterrupt); ``partial`` is the solution up to there.
    """
    begin = time.perf_counter()
    from fricmb.integrate.compile.few_collections import few_collections

    with few_collections():  # what the first call loads stays
        from fricmb._simulate._blas import blas_threads
        from fricmb._simulate._compile_watch import CompileWatch

    with few_collections(), CompileWatch() as compiling, blas_threads(scene):
        from fricmb._simulate._arguments import (
            check_limit,
            check_memory,
            check_sensitivities,
            check_span,
            check_step,
            check_tolerance,
            floors,
            number,
        )
        from fricmb._simulate._asked_events import check_events, with_observed
        from fricmb._simulate._ended import run_watched
        from fricmb._simulate._islands import find_runs
        from fricmb._simulate._keep import check_keep, run
        from fricmb._simulate._mechanics import prepare
        from fricmb._simulate._progress import progress_bar
        from fricmb._simulate._result import differentiated, make_solution
        from fricmb._simulate._start import find_start
        from fricmb.integrate.run.memory import Footprint
        from fricmb.integrate.run.stop import Watch, watching

        mechanics = prepare(scene, parameters, with_observed(observe, events))
        looked_for = check_events(mechanics, events, terminal)
        start, mechanics = find_start(mechanics, initial, number("t_start", t_start, "a finite time"))
        span = check_span(start.t, t_end, t_eval)
        tolerance = check_tolerance(rtol, atol, start.q.size, max_step)
        chosen = find_runs(mechanics, method, start, span, tolerance.rtol)
        fixed = check_step(step, chosen.adaptive, chosen.name, span.t_end - span.t_start)
        keep = check_keep(dense, chunk, on_chunk, span, looked_for)
        asked = check_sensitivities(mechanics.scene, sensitivities, on_chunk)
        if on_chunk is None:
            check_memory(2 * start.q.size + len(mechanics.names.contacts) + 3, span)
        watch = Watch(check_limit(time_limit), Footprint(), since=begin)

        accuracy = rtol if chosen.adaptive else None

        def finish(trajectory: Trajectory, part: Span, found: LooksFor | None) -> Solution:
            how = (chosen.name, chosen.why, begin, compiling.seconds, accuracy, floors(tolerance))
            with watching(None):
                ended = watch.reason is not None
                return make_solution(chosen.mechanics, trajectory, part, *how, ended=ended, asked=found)

        with progress_bar(progress, span.t_start, span.t_end) as forward:
            options = {"tolerance": tolerance, "step": fixed, "progress": forward}
            sol = run_watched(
                watch, lambda: run(keep, chosen.integrator, chosen.problem, start, span, finish, **options),
                chosen.name, span.t_start,
            )  # fmt: skip
        return differentiated(sol, asked)
