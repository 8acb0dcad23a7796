"""The order of the layers, and that what is packaged is what is there."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

#: A module imports, when it is itself imported, only from its own floor or a lower one.
FLOORS = (
    {"dae", "errors", "integrate", "reduction", "solution", "values"},
    {"laws", "normal"},
    {"scene", "space"},
    {"plan"},
    {"equations"},
    {"stated", "system"},
    {"simulate", "sweep"},
    {"analysis", "audit", "fit", "sensitivity"},
    {"plot"},
    {"models", "testing", "bench", "precompile"},
    {"cli"},
)
#: Inside `integrate`, imports inside functions counted: what a problem is and what a run returns; compilation; what
#: goes on around any run; forces and accelerations; rows that a run leaves; one implicit step; transitions; methods.
ENGINE = (
    {"problem", "once_per", "array_cache", "mechanism", "csr", "trajectory", "integrator"},
    {"compile"},
    {"run"},
    {"model"},
    {"output"},
    {"step"},
    {"contact"},
    {"methods", "suits_taylor"},
    {"collocation", "constrained", "taylor", "timestepping"},
    {"guard", "guarded_taylor", "named"},
    {"select"},
)
#: Methods that hand scenes with joints on to steps of their own kind.
HANDED_ON = {("bdf", "constrained"), ("radau", "constrained")}
#: The package's front door and `python -m fricmb` stand outside the floors.
OUTSIDE = {"__init__", "__main__"}


def floor(name):
    return next(i for i, layers in enumerate(FLOORS) if name in layers)


def sources():
    return sorted([*(ROOT / "fricmb").rglob("*.py"), *(ROOT / "models").rglob("*.py")])


def layer(path):
    """The layer that a file belongs to: `fricmb/plan/_graph.py` -> plan, `fricmb/simulate.py` -> simulate."""
    parts = path.relative_to(ROOT).parts
    if parts[0] == "models":
        return "models"
    return (
        (parts[1] if len(parts) > 2 else path.stem).lstrip("_")
        if path.stem not in OUTSIDE or len(parts) > 2
        else path.stem
    )


def package(path):
    parts = path.relative_to(ROOT).with_suffix("").parts[:-1]
    return ("fricmb", *parts) if parts[0] == "models" else parts


def imports_at_module_level(path):
    """(line, layer) of every import of fricmb that runs on import; those under TYPE_CHECKING do not."""
    here = package(path)
    for node in statements(ast.parse(path.read_text()).body):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else ()
            module = ".".join((*base, *(node.module or "").split("."))).strip(".")
            names = [f"fricmb.{alias.name}" for alias in node.names] if module == "fricmb" else [module]
        yield from ((node.lineno, name.split(".")[1].lstrip("_")) for name in names if name.startswith("fricmb."))


def statements(body):
    for node in body:
        yield node
        if isinstance(node, (ast.If, ast.Try)) and "TYPE_CHECKING" not in ast.unparse(node).partition("\n")[0]:
            yield from statements(node.body)


@pytest.mark.parametrize("path", sources(), ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_only_go_down(path):
    here = layer(path)
    if here in OUTSIDE:
        return
    known = {name for layers in FLOORS for name in layers}
    upwards = [
        f"line {line}: {other}"
        for line, other in imports_at_module_level(path)
        if other in known and floor(other) > floor(here)
    ]
    assert not upwards, f"{here} imports from a higher floor: {upwards}"


def test_imports_inside_the_engine_only_go_down():
    top = ROOT / "fricmb" / "integrate"

    def level(name):
        return next(i for i, names in enumerate(ENGINE) if name in names)

    upwards, seen = [], set()
    for path in sorted(top.rglob("*.py")):
        parts = path.relative_to(top).with_suffix("").parts
        if parts == ("__init__",):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.ImportFrom) or not (node.module or "").startswith("fricmb.integrate"):
                continue
            base = (node.module or "").split(".")[2:]
            for other in {base[0]} if base else {alias.name for alias in node.names}:
                if (parts[-1], other) in HANDED_ON:
                    seen.add((parts[-1], other))
                elif level(other) > level(parts[0]):
                    upwards.append(f"{'/'.join(parts)}, line {node.lineno}: {other}")
    assert not upwards
    assert seen == HANDED_ON


def test_ground_floor_stands_alone():
    """`integrate` could be shipped with the errors alone."""
    for path in sources():
        if layer(path) == "integrate":
            others = {other for _, other in imports_at_module_level(path)}
            assert others <= {"integrate", "errors"}, path


def test_every_folder_is_packaged():
    """A wheel holds what the list names: a folder that is missing from it works in the checkout alone."""
    folders = {".".join(path.parent.relative_to(ROOT).parts) for path in (ROOT / "fricmb").rglob("__init__.py")} | {
        ".".join(("fricmb", *path.parent.relative_to(ROOT).parts)) for path in (ROOT / "models").rglob("__init__.py")
    }
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    assert sorted(listed) == sorted(folders)
    bare = [p for p in sources() if not (p.parent / "__init__.py").exists()]
    assert not bare, "folders of code without __init__.py are left out of the wheel"


def test_models_have_one_name():
    """The folder is not importable as `models`, where its classes would exist twice."""
    source = (ROOT / "models" / "__init__.py").read_text()
    with pytest.raises(ImportError, match=r"fricmb\.models"):
        exec(compile(source, "models/__init__.py", "exec"), {"__name__": "models"})


def test_models_are_found_from_the_root_of_a_clone():
    """Where the working folder comes before what is installed, the models are those beside it."""
    code = (
        "import sys; sys.meta_path = [f for f in sys.meta_path if 'editable' not in repr(f).lower()]\n"
        "import fricmb as fm; print(fm.models.__file__, len(fm.models.brake4dof().parts))"
    )
    found = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert found.stdout.split() == [str(ROOT / "models" / "__init__.py"), "9"]
