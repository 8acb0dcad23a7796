"""What the pages of public names show beside their docstrings: which members, an example with its output, a picture."""

import contextlib
import hashlib
import inspect
import io
import json
import re
import sys
import types
from pathlib import Path

import _examples

import fricmb as fm

#: Machinery of declarations that every part and law inherits; authors of laws and elements find theirs in the how-tos.
LAW = [
    "coefficient", "derivative", "force", "rate", "break_away", "slip_limit", "creep", "regularised", "bristle",
    "example", "from_backbone",
]  # fmt: skip
WRITTEN = ["states", "validate", "define_coefficient", "define_force", "define_rate", "copies"]
PART = [
    "point", "from_matrices", "from_mesh", "from_fe", "from_test", "matrix", "frf", "compare", "complex_modes",
    "dof_names", "define_joint",
]  # fmt: skip
BASES = {
    "Element": ["local_coordinates", "define_potential", "define_dissipation", "define_force"],
    "Joint": ["local_coordinates", "define_constraint", "define_slip", "define_load"],
    "NormalLaw": ["define_normal", "define_stored", "validate"],
    "FrictionLaw": LAW + WRITTEN,
    "Scene": [
        "with_parameters", "replace", "with_units", "equations", "plan", "graph", "draw", "dof_names", "parameters",
    ],
}


def shown(module: str, name: str, members: list[str]) -> list[str]:
    """Members of a class that its page shows: what users call, not how a declaration becomes numbers."""
    kind = getattr(sys.modules[module], name)
    own = [member for member in members if not member.startswith("_")]
    if name in BASES:
        allowed = BASES[name]
    elif issubclass(kind, fm.FrictionLaw):
        allowed = [member for member in LAW if member in vars(kind)]
    elif issubclass(kind, _declared()):
        allowed = PART
    else:
        fields = getattr(kind, "__dataclass_fields__", {})
        return [member for member in own if member not in fields and inspect.getdoc(getattr(kind, member, None))]
    return [member for member in allowed if member in own]


def _declared() -> type:
    """What all declarations share: parts, laws, normal-force laws."""
    return next(base for base in fm.FrictionLaw.__mro__ if base in fm.Body.__mro__)


def type_links(reference: Path) -> dict[str, str]:
    """Names of types in docstrings, and what they link to: public names of the reference that are no two things.

    Names of other packages (numpydoc's own list) link to nothing: their pages are not on this machine.
    """
    from numpydoc.xref import DEFAULT_LINKS

    listed = [line.strip() for page in ("api.md", "laws.md") for line in (reference / page).read_text().splitlines()]
    public = [name for name in listed if re.fullmatch(r"(\w+\.)?[A-Z]\w+", name)]
    last = [name.rpartition(".")[2] for name in public]
    links = {short: f"fricmb.{name}" for short, name in zip(last, public, strict=True) if last.count(short) == 1}
    return {**{name: name for name in DEFAULT_LINKS}, **links}


#: Characters of LaTeX.
LONGEST = 400


# -- examples -------------------------------------------------------------------------------------------------------
def public_name(full: str) -> str:
    """A name as it is called in ``fm``."""
    return full.removeprefix("fricmb.")


class Shown:
    """Runs examples and keeps what they print and draw, by their code, so that a second build need not run them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "api"
        self.folder.mkdir(parents=True, exist_ok=True)
        self._file = self.folder / "printed.json"
        self._kept = json.loads(self._file.read_text()) if self._file.exists() else {}

    def of(self, code: str) -> tuple[str, str | None]:
        """What an example prints, and the name of its picture."""
        key = hashlib.sha256(f"{fm.__version__} {code}".encode()).hexdigest()[:16]
        if key not in self._kept:
            self._kept[key] = self._run(code, key)
            self._file.write_text(json.dumps(self._kept))
        printed, picture = self._kept[key]
        return printed, picture

    def _run(self, code: str, key: str) -> tuple[str, str | None]:
        printed, figure = run(code)
        if figure is None:
            return printed, None
        figure.savefig(self.folder / f"{key}.png", dpi=100)
        return printed, f"{key}.png"


def run(code: str):
    """What an example prints, and its picture or None."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    import fricmb as fm

    module = types.ModuleType("api_example")  # what it declares can be pickled
    sys.modules[module.__name__] = module
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "example", "exec"), module.__dict__)
    plt.close("all")
    fm.plot.use(None)  # an example may have chosen a theme: the next one starts as a user does
    return out.getvalue(), module.__dict__.get("figure")


def add_example(kept: Shown):
    """Puts the example of a public name behind its docstring."""

    def process(app, what, name, obj, options, lines):
        code = _examples.example(public_name(name))
        if code is None or what not in ("class", "function", "exception"):
            return
        is_model = name.startswith("fricmb.models.")
        printed, picture = ("", f"/reference/_{obj.__name__}_run.png") if is_model else kept.of(code)
        lines += ["", *formula(obj), ".. rubric:: Example", "", ".. code-block:: python", ""]
        lines += [f"   {line}" for line in code.splitlines()]
        if printed.strip():
            lines += ["", ".. code-block:: text", "", *(f"   {line}" for line in printed.rstrip().splitlines())]
        if picture:
            path = picture if is_model else f"/_made/api/{picture}"
            lines += ["", f".. image:: {path}", f"   :alt: Picture that the example of {obj.__name__} draws", ""]

    return process


def formula(kind) -> list[str]:
    """The equations of a law as it states them, along one direction, typeset."""
    if not (isinstance(kind, type) and issubclass(kind, fm.FrictionLaw) and kind.__name__ in fm.laws.names):
        return []
    lines = []
    for left, right in _equations(kind.example()):
        if len(right) < LONGEST:  # of laws with many branches the docstring tells more than their formula
            lines += [".. math::", "", f"   {left} = {right}", ""]
    return lines


def _equations(law):
    """Left and right sides, in LaTeX."""
    import sympy

    made = fm.laws.symbolic(law).standin
    r, v, N = sympy.Symbol("r", positive=True), sympy.Symbol("v", real=True), sympy.Symbol("N", positive=True)
    try:
        if not law.states:
            takes_load = len(inspect.signature(made.define_coefficient).parameters) == 2
            yield r"\mu", _latex(made.define_coefficient(r, N) if takes_load else made.define_coefficient(r))
            return
        n = law.n_states(1)
        z = tuple(sympy.Symbol(law.states[0] if n == 1 else f"{law.states[0]}{i}", real=True) for i in range(1, n + 1))
        force, rate = made.define_force((v,), N, z), made.define_rate((v,), N, z)
    except (NotImplementedError, fm.LawError):
        return  # compiled, or of measured points
    yield "F", _latex(force[0] if isinstance(force, tuple) else force)
    for name, value in zip(z, rate if isinstance(rate, tuple) else (rate,), strict=False):
        yield rf"\dot {{{sympy.latex(name)}}}", _latex(value)


def _latex(expression) -> str:
    """Without what keeps roots off zero; names that are words upright."""
    import sympy

    expression = sympy.sympify(expression)
    tiny = {number: 0 for number in expression.atoms(sympy.Float) if abs(number) < 1e-100}
    words = {}
    for symbol in expression.free_symbols:
        name = symbol.name.rpartition(".")[2]
        head, _, below = name.partition("_")
        plain = sympy.latex(sympy.Symbol(name))
        is_letter = "\\" in plain or head.rstrip("0123456789")[1:] == ""
        words[symbol] = plain if is_letter else rf"\mathrm{{{head}}}" + (f"_{{{below}}}" if below else "")
    return sympy.latex(expression.xreplace(tiny), symbol_names=words, mul_symbol=r" \, ")
