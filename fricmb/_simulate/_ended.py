"""A run that something from outside may end: what is raised then."""

from __future__ import annotations

from collections.abc import Callable

from fricmb.errors import IntegrationError, Interrupted
from fricmb.integrate.run.memory import refused
from fricmb.integrate.run.stop import Watch, watching
from fricmb.solution import Solution


def run_watched(watch: Watch, run: Callable[[], Solution], method: str, t_start: float) -> Solution:
    """The solution that ``run`` returns, under a watch; ``method`` and ``t_start`` are for messages.

    Raises
    ------
    IntegrationError
        Where the run could not go on, a limit was reached, or the system gave no more memory.
    Interrupted
        After Ctrl-C; what a handler of the user's own raises is raised as it is.
    """
    try:
        with watching(watch):
            solution = run()
    except IntegrationError as error:
        if watch.cause is None:
            raise
        if not isinstance(watch.cause, KeyboardInterrupt):
            raise watch.cause from error
        raise error.passed_on(Interrupted) from None
    except MemoryError as error:
        reason = refused(error)
        said = f"{method} stopped: {reason}"
        raise IntegrationError(said, t=t_start, reason=reason) from None
    if watch.cause is not None:  # it came while the last step was made
        if not isinstance(watch.cause, KeyboardInterrupt):
            raise watch.cause
        t = float(solution.t[-1])
        said = f"interrupted at the end of the run, t = {t:.10g}"
        raise Interrupted(said, t=t, reason="interrupted", partial=solution)
    return solution
