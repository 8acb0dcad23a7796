"""The picture of the layers, made from the imports that the code has."""

import ast
from collections import Counter
from pathlib import Path

from matplotlib.figure import Figure

import fricmb

# Floors from below, as the page names them; a package that is new stands out until it is given a place.
PACKAGE = (
    (
        "calls", "errors", "values", "fe", "integrate", "dae", "reduction", "files", "measure", "signal", "solution",
        "facade", "version",
    ),
    ("laws", "normal"),
    ("scene", "space"),
    ("equations",),
    ("plan",),
    ("system", "stated"),
    ("field",),
    ("simulate", "sweep"),
    ("analysis", "audit", "sensitivity", "fit"),
    ("plot",),
    ("squeal",),
    ("models", "testing", "bench", "precompile"),
    ("cli",),
)
ENGINE = (
    ("problem", "trajectory", "integrator", "mechanism", "csr"),
    ("compile",),
    ("run",),
    ("signals",),
    ("model",),
    ("formulas",),
    ("suits_taylor",),
    ("collocation", "implicit", "taylor"),
    ("methods",),
    ("guard", "guarded_taylor", "named"),
    ("select",),
)
#: What everybody imports: no lines.
EVERYWHERE = ("calls", "errors", "facade", "values", "version", "problem")
ROOT = Path(fricmb.__file__).parent


def _files(root: Path) -> dict[Path, str]:
    """Python files below a package, and the package that each is in."""
    found = {}
    for path in root.rglob("*.py"):
        parts = path.relative_to(root).parts
        found[path] = (parts[0] if len(parts) > 1 else path.stem).lstrip("_")
    return found


def _imported(path: Path, prefix: str) -> set[str]:
    """Packages below a prefix such as ``"fricmb."`` that a file imports, inside functions too."""
    packages = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        packages |= {name.removeprefix(prefix).split(".")[0].lstrip("_") for name in names if name.startswith(prefix)}
    return packages


def _facts(root: Path, prefix: str) -> tuple[Counter, Counter]:
    """Lines of each package, and how many files of one import from another."""
    lines: Counter = Counter()
    arrows: Counter = Counter()
    for path, package in _files(root).items():
        lines[package] += len(path.read_text(encoding="utf-8").splitlines())
        for other in _imported(path, prefix) - {package}:
            arrows[package, other] += 1
    return lines, arrows


def _panel(ax, floors, lines: Counter, arrows: Counter, title: str) -> None:
    """Floors one above the other, packages as boxes, imports as lines; those between packages of one floor are bent."""
    at = {package: ((k + 0.5) / len(floor), y) for y, floor in enumerate(floors) for k, package in enumerate(floor)}
    for (package, other), count in arrows.items():
        if package in at and other in at and other not in EVERYWHERE:
            (x, y), (u, v) = at[package], at[other]
            bend = 0.15 if y == v else 0.0
            ax.annotate(
                "", (u, v), (x, y), zorder=1,
                arrowprops={
                    "arrowstyle": "-", "color": "#006ba4", "alpha": 0.35, "linewidth": min(4.0, 0.4 + 0.12 * count),
                    "connectionstyle": f"arc3,rad={bend}",
                },
            )  # fmt: skip
    for package, place in at.items():
        label = f"{package}\n{lines[package]}" if lines[package] else package
        ax.text(*place, label, ha="center", va="center", fontsize=7, zorder=2,
                bbox={"boxstyle": "round,pad=0.3", "facecolor": "white", "edgecolor": "#404040", "linewidth": 0.8},
        )  # fmt: skip
    ax.set(xlim=(0, 1), ylim=(-0.6, len(floors) - 0.4))
    ax.axis("off")
    ax.set_title(title, fontsize=9)


def draw(file: Path) -> None:
    """Write the picture."""
    figure = Figure(figsize=(9.5, 6.5), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    models = Path(fricmb.models.__file__).parent
    lines, arrows = _facts(ROOT, "fricmb.")
    lines["models"] = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in models.rglob("*.py"))
    _panel(left, PACKAGE, lines, arrows, "fricmb: packages and their lines; who imports from whom")
    _panel(right, ENGINE, *_facts(ROOT / "integrate", "fricmb.integrate."), "the packages of integrate")
    figure.savefig(file)
