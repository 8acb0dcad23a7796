"""The command line: arguments, dispatch, exit status."""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NoReturn, TypeAlias

from fricmb import __version__
from fricmb.cli._kinds import KINDS, NEED_NAME

DONE, BAD_INPUT, FAILED = 0, 2, 3

_EPILOG = """exit status: 0 done, 2 bad input (one line on stderr says what and what is accepted),
3 the integration failed (what was computed until then is kept)"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status (argparse itself exits with 0 or 2)."""
    closed = sys.stdout is None
    if closed:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115  # for the rest of the process
    options = parser().parse_args(arguments)
    _set_up(options)
    from fricmb.errors import FricmbError, IntegrationError
    from fricmb.integrate.compile.few_collections import few_collections
    from fricmb.integrate.run.ending_signals import as_interrupts

    try:
        command: Callable[[argparse.Namespace], int] = options.command
        with _notices(options), few_collections(), as_interrupts():  # what a command loads stays until its end
            status = command(options)
        _flush()
    except IntegrationError as error:
        return _complain(str(error), FAILED)
    except BrokenPipeError:  # whoever reads the output has seen enough
        _let_go()
        return DONE
    except (FricmbError, OSError) as error:
        return _complain(str(error), BAD_INPUT)
    except KeyboardInterrupt:
        return _complain("interrupted", 130)
    return _complain("standard output is closed: output to it is lost", BAD_INPUT) if closed else status


@contextlib.contextmanager
def _notices(options: argparse.Namespace) -> Iterator[None]:
    """Silence notices while a quiet command runs, in processes that it starts as well; not those of the caller."""
    before = os.environ.get("FRICMB_QUIET")
    if getattr(options, "quiet", False):
        os.environ["FRICMB_QUIET"] = "1"
    try:
        yield
    finally:
        os.environ.pop("FRICMB_QUIET", None)
        if before is not None:
            os.environ["FRICMB_QUIET"] = before


def _set_up(options: argparse.Namespace) -> None:
    """Set threads and messages before numpy and numba are imported, which read their environment once."""
    threads = getattr(options, "threads", None)
    if threads is not None:
        for library in ("OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM", "NUMBA"):
            os.environ[f"{library}_NUM_THREADS" if "_" not in library else f"{library}_THREADS"] = str(threads)
        os.environ["FRICMB_COMPILE_PROCESSES"] = str(threads)
    # else numba sets up colours for messages that nobody sees, and the terminal gets an escape sequence at the end
    os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")


def _threads(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a number of threads, at least 1; got {text!r}")
    return int(text)


def _flush() -> None:
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise OSError(f"standard output: {error.strerror}: its last output is lost") from error


def _let_go() -> None:
    """Drop what standard output could not take, so that the interpreter does not try again at its end."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _complain(message: str, status: int) -> int:
    try:
        sys.stdout.flush()
    except (OSError, ValueError):
        _let_go()
    with contextlib.suppress(OSError, ValueError, AttributeError):
        print("fricmb: " + " ".join(message.split()), file=sys.stderr)
    return status


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, as every other error here."""

    def error(self, message: str) -> NoReturn:
        self.exit(BAD_INPUT, f"{self.prog}: {message}; see {self.prog} --help\n")


def parser() -> argparse.ArgumentParser:
    """The whole grammar; the work behind a command is imported when it runs."""
    top = _Parser(
        prog="fricmb",
        description="Friction-induced vibration: run scenes of bodies, springs and contacts with dry friction.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"fricmb {__version__}")
    commands = top.add_subparsers(title="commands", required=True, metavar="COMMAND")
    _add_run(commands)
    _add_list(commands)
    _add_law(commands)
    _add_equations(commands)
    _add_plan(commands)
    _add_squeal(commands)
    _add_bench(commands)
    _add_figures(commands)
    _add_export(commands)
    _add_plot(commands)
    _add_compile(commands)
    return top


_Commands: TypeAlias = "argparse._SubParsersAction[_Parser]"


def _command(commands: _Commands, name: str, summary: str, run: str, *, model: bool = False) -> argparse.ArgumentParser:
    """A sub-command that runs the function ``module:name`` of this package; with ``model`` it takes a scene."""

    def command(options: argparse.Namespace) -> int:
        from importlib import import_module

        module, _, function = run.partition(":")
        status: int = getattr(import_module(f"fricmb.cli.{module}"), function)(options)
        return status

    sub = commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    sub.set_defaults(command=command)
    if model:
        sub.add_argument(
            "model", metavar="MODEL", help="a built-in model (see fricmb list) or a Python file that defines scene"
        )
        sub.add_argument("--case", help="case of the model, as its argument case")
        sub.add_argument(
            "--set",
            action="append",
            default=[],
            metavar="NAME=VALUE",
            dest="values",
            help="an argument of the model if it has one of that name, else a parameter of the scene, or a law, "
            "sole.law='Coulomb(mu_s=0.5)'; may be repeated",
        )
    return sub


def _add_run(commands: _Commands) -> None:
    sub = _command(commands, "run", "simulate a model; write a summary, the data and pictures", "_run:run", model=True)
    sub.add_argument(
        "--t-end", type=float, metavar="T", help="end of the run; default: the model's, or t_end in the file"
    )
    sub.add_argument("--rtol", type=float, default=1e-6, metavar="R", help="relative tolerance (default: %(default)g)")
    sub.add_argument("--method", default="auto", metavar="NAME", help="integrator (default: %(default)s)")
    sub.add_argument("--step", type=float, metavar="H", help="step of a fixed-step method")
    limit = (
        "seconds after which the run ends, with status 3; tables and pictures that need more than a tenth of this "
        "(or 5 s) in addition are left out"
    )
    sub.add_argument("--time-limit", type=float, metavar="S", help=limit)
    sub.add_argument(
        "--points",
        type=int,
        metavar="N",
        help="write N equidistant times instead of the accepted steps; pictures then show these, too",
    )
    sub.add_argument("--out", type=Path, metavar="DIR", help="folder for the results (default: fricmb-out/MODEL)")
    sub.add_argument("--no-plots", action="store_true", help="no pictures")
    _add_format(sub)
    sub.add_argument("--yes", action="store_true", help="write a run of gigabytes without asking")
    sub.add_argument("--audit", action="store_true", help="check the run against the scene's equations: sol.audit()")
    sub.add_argument("--json", action="store_true", help="print the summary as JSON and nothing else")
    sub.add_argument("--quiet", action="store_true", help="print only errors and the requested output")
    sub.add_argument("--threads", type=_threads, metavar="N", help="threads of linear algebra and compilation")


def _add_list(commands: _Commands) -> None:
    sub = _command(commands, "list", "list models, parts, laws and integrators", "_show:show_list")
    sub.add_argument("what", nargs="?", choices=("models", "parts", "laws", "integrators"), help="only these")


def _add_law(commands: _Commands) -> None:
    sub = _command(commands, "law", "draw a friction law: coefficient, hysteresis, break-away, lag", "_law:show_law")
    sub.add_argument("law", metavar="NAME", help="a law of fricmb list laws")
    sub.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", dest="values", help="a parameter; may be repeated"
    )
    sub.add_argument("--normal-force", type=float, default=1.0, metavar="N", help="normal force (default: %(default)g)")
    sub.add_argument(
        "--out", type=Path, default=Path("fricmb-out/laws"), metavar="DIR", help="folder (default: %(default)s)"
    )
    _add_format(sub)


def _add_format(sub: argparse.ArgumentParser) -> None:
    kinds = ("png", "svg", "pdf")
    text = "of the pictures; svg and pdf are vector graphics (default: %(default)s)"
    sub.add_argument("--format", choices=kinds, default="png", help=text)


def _add_equations(commands: _Commands) -> None:
    sub = _command(commands, "equations", "print a scene's equations of motion", "_show:show_equations", model=True)
    sub.add_argument("--latex", action="store_true", help="typeset with LaTeX")


def _add_plan(commands: _Commands) -> None:
    _command(
        commands,
        "plan",
        "print what a run of a scene will build, what it leaves out, and why",
        "_show:show_plan",
        model=True,
    )


def _add_squeal(commands: _Commands) -> None:
    summary = "study where steady sliding squeals, and why; write a report and tables"
    sub = _command(commands, "squeal", summary, "_squeal:squeal", model=True)
    over = "a parameter and its values, FIRST:LAST:COUNT or A,B,C; once or twice"
    sub.add_argument("--over", action="append", default=[], metavar="NAME=VALUES", help=over)
    held = "a degree of freedom whose speed counts as constant; may be repeated"
    sub.add_argument("--speed", action="append", default=[], metavar="NAME=V", help=held)
    sub.add_argument("--highest", type=float, metavar="W", help="angular frequency above which modes are left out")
    sub.add_argument("--growth", action="store_true", help="compare the rate of growth with that in a run")
    sub.add_argument("--saturation", action="store_true", help="run until the vibration keeps its size")
    spread = "an uncertain parameter: a relative standard deviation or LOW:HIGH; may be repeated"
    sub.add_argument("--uncertain", action="append", default=[], metavar="NAME=SPREAD", help=spread)
    points = "points of each of eight scramblings, a power of 2 (default: %(default)d)"
    sub.add_argument("--samples", type=int, default=32, metavar="N", help=points)
    sub.add_argument("--workers", type=_threads, default=1, metavar="N", help="processes (default: %(default)d)")
    sub.add_argument(
        "--store", type=Path, metavar="DIR", help="keeps what was computed: the same study goes on from it"
    )
    sub.add_argument("--out", type=Path, metavar="DIR", help="folder (default: fricmb-out/MODEL-squeal)")
    sub.add_argument("--quiet", action="store_true", help="say nothing but errors")


def _add_compile(commands: _Commands) -> None:
    sub = _command(commands, "compile", "compile all kernels ahead of use, into the cache", "_compile:compile_ahead")
    sub.add_argument(
        "--processes", type=_threads, metavar="N", help="number of processes (default: one for each processor)"
    )
    sub.add_argument("--into", type=Path, metavar="DIR", help="folder for a copy of everything that was compiled")
    sub.add_argument("--quiet", action="store_true", help="say nothing")


def _add_bench(commands: _Commands) -> None:
    sub = _command(commands, "bench", "measure error against run time, or stability, of integrators", "_bench:bench")
    kinds = ("suite", "stability")
    sub.add_argument("what", nargs="?", choices=kinds, default="suite", help="what to measure (default: %(default)s)")
    quick = "a few scenes and settings: about half a minute, the first time longer"
    sub.add_argument("--quick", action="store_true", help=quick)
    sub.add_argument(
        "--scene", action="append", default=[], metavar="NAME", help="only this scene of the suite; may be repeated"
    )
    sub.add_argument(
        "--limit", type=float, default=60.0, metavar="S", help="seconds until a run is ended (default: %(default)g)"
    )
    sub.add_argument("--again", action="store_true", help="start again, do not continue an earlier run")
    sub.add_argument(
        "--out", type=Path, default=Path("fricmb-out/bench"), metavar="DIR", help="folder (default: %(default)s)"
    )
    sub.add_argument("--json", action="store_true", help="print the figures as JSON")


def _add_figures(commands: _Commands) -> None:
    sub = _command(commands, "figures", "draw the figures of the paper that the brake comes from", "_figures:figures")
    sub.add_argument(
        "model", metavar="MODEL", nargs="?", default="brake4dof", help="whose figures (default: %(default)s)"
    )
    sub.add_argument(
        "--out", type=Path, default=Path("fricmb-out/figures"), metavar="DIR", help="folder (default: %(default)s)"
    )
    sub.add_argument("--rtol", type=float, default=1e-8, metavar="R", help="relative tolerance (default: %(default)g)")
    sub.add_argument("--t-end", type=float, default=700.0, metavar="T", help="end of the runs (default: %(default)g)")
    sub.add_argument("--case", action="append", metavar="CASE", help="only this case; may be repeated")
    _add_format(sub)


def _add_export(commands: _Commands) -> None:
    sub = _command(commands, "export", "write the signals of a saved run for other programs", "_export:export")
    sub.add_argument("solution", metavar="FILE", type=Path, help="a solution.npz that fricmb run or sol.save wrote")
    sub.add_argument("out", metavar="OUT", type=Path, help="file to write: .mat (MATLAB), .h5 (HDF5) or .csv")
    sub.add_argument("--signals", metavar="NAMES", help="only these, with commas: pad.x,lining.force.x")
    sub.add_argument("--laws", type=Path, metavar="FILE.py", help="where own laws are defined; this file is run")


def _add_plot(commands: _Commands) -> None:
    sub = _command(commands, "plot", "draw, animate or sonify a saved run", "_plot:plot")
    sub.add_argument("solution", metavar="FILE", type=Path, help="a solution.npz that fricmb run or sol.save wrote")
    sub.add_argument(
        "kind",
        metavar="KIND",
        help=f"{', '.join(KINDS[:-1])} or {KINDS[-1]}; {', '.join(NEED_NAME)} need --of",
    )
    sub.add_argument("--laws", type=Path, metavar="FILE.py", help="where own laws are defined; this file is run")
    what = "what to show: a motion, contact, element or signal, such as pad.y; several with commas"
    sub.add_argument("--of", metavar="NAME", help=what)
    sub.add_argument("--hz", action="store_true", help="spectra: frequency in place of angular frequency")
    sub.add_argument("--theme", choices=("light", "dark"), help="colours for a light or a dark page")
    kinds = "default: KIND.png, .gif, .wav or .html beside FILE; .svg and .pdf are vector graphics"
    sub.add_argument("--out", type=Path, metavar="FILE", help=kinds)
    sub.add_argument("--t-start", type=float, metavar="T", help="start of the part shown; default: that of the run")
    sub.add_argument("--t-end", type=float, metavar="T", help="end of the part shown; default: that of the run")
    sub.add_argument("--frames", type=int, metavar="N", help="animation: pictures (default: 32 for each swing)")
    sub.add_argument("--seconds", type=float, default=3.0, metavar="S", help="sound: length (default: %(default)g)")
