"""The order of the layers, and that what is packaged is what is there."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import networkx
import pytest

ROOT = Path(__file__).parents[1]

#: A module imports only from its own floor or a lower one, imports inside functions counted; what users expect on a
#: low floor and a higher one does is named in `fricmb/_facade.py`.
FLOORS = (
    {
        "calls", "dae", "errors", "facade", "fe", "files", "integrate", "measure", "reduction", "signal", "solution",
        "values", "version",
    },
    {"laws", "normal"},
    {"scene", "space"},
    {"equations"},
    {"plan"},
    {"stated", "system"},
    {"field"},
    {"simulate", "sweep"},
    {"analysis", "audit", "fit", "sensitivity"},
    {"plot"},
    {"squeal"},
    {"models", "testing", "bench", "precompile"},
    {"cli"},
)
#: Inside `integrate`, imports inside functions counted: what a problem is and what a run returns; compilation; what
#: goes on around any run; inputs; forces and laws; formulas and step control; the engines; methods by their names.
ENGINE = (
    {"problem", "event_kinds", "once_per", "array_cache", "mechanism", "csr", "trajectory", "integrator"},
    {"compile"},
    {"run"},
    {"signals"},
    {"model"},
    {"formulas"},
    {"suits_taylor"},
    {"collocation", "implicit", "taylor"},
    {"methods"},
    {"guard", "guarded_taylor", "named"},
    {"select"},
)
#: Circles of modules that import one another, imports inside functions counted, are of at most so many; those of laws,
#: which can be turned into one another, and of the engine apart.
CIRCLE = 6
APART = ("fricmb.laws", "fricmb.integrate")
#: From this floor on modules may come in by the package's front door, `import fricmb`.
BY_THE_DOOR = "models"
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


def imports(path):
    """(line, name) of all that a file imports, inside functions too; what stands under TYPE_CHECKING is not imported.

    ``from x import y`` gives ``x.y``, which is a module or a name in one.
    """
    here = package(path)
    for node in statements(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else ()
            module = ".".join((*base, *(node.module or "").split("."))).strip(".")
            yield from ((node.lineno, f"{module}.{alias.name}") for alias in node.names)


def statements(node):
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            continue
        yield child
        yield from statements(child)


def imported_layers(path):
    for line, name in imports(path):
        if name.startswith("fricmb."):
            yield line, name.split(".")[1].lstrip("_")


@pytest.mark.parametrize("path", sources(), ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_only_go_down(path):
    here = layer(path)
    if here in OUTSIDE:
        return
    known = {name for layers in FLOORS for name in layers}
    upwards = [
        f"line {line}: {other}"
        for line, other in imported_layers(path)
        if other in known and floor(other) > floor(here)
    ]
    assert not upwards, f"{here} imports from a higher floor: {upwards}"
    if floor(here) < floor(BY_THE_DOOR):
        assert "fricmb" not in [name for _, name in imports(path)], "the front door leads to every floor"


def test_there_are_no_large_circles():
    names = {".".join((*package(path), *([] if path.stem == "__init__" else [path.stem]))): path for path in sources()}
    graph = networkx.DiGraph()
    for name, path in names.items():
        for _, other in imports(path):
            found = other if other in names else other.rpartition(".")[0]
            if found in names and found != name:
                graph.add_edge(name, found)
    circles = [c for c in networkx.strongly_connected_components(graph) if len(c) > CIRCLE]
    assert not [c for c in circles if not any(all(name.startswith(top) for name in c) for top in APART)]
    assert graph.number_of_edges() > 3000  # imports are found
    assert nested_import_is_seen(names, graph)


def nested_import_is_seen(names, graph):
    """Whether an import that stands inside a function only counts."""
    assert "fricmb.plot._animation" not in ast.unparse(ast.parse(names["fricmb.plot._html"].read_text()).body[:9])
    return graph.has_edge("fricmb.plot._html", "fricmb.plot._animation")


def test_imports_inside_the_engine_only_go_down():
    top = ROOT / "fricmb" / "integrate"

    def level(name):
        return next(i for i, names in enumerate(ENGINE) if name in names)

    upwards = []
    for path in sorted(top.rglob("*.py")):
        parts = path.relative_to(top).with_suffix("").parts
        if parts == ("__init__",):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.ImportFrom) or not (node.module or "").startswith("fricmb.integrate"):
                continue
            base = (node.module or "").split(".")[2:]
            for other in {base[0]} if base else {alias.name for alias in node.names}:
                if level(other) > level(parts[0]):
                    upwards.append(f"{'/'.join(parts)}, line {node.lineno}: {other}")
    assert not upwards


def test_ground_floor_stands_alone():
    """`integrate` could be shipped with the errors alone."""
    for path in sources():
        if layer(path) == "integrate":
            others = {other for _, other in imported_layers(path)}
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
