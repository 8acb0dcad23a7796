"""Sphinx configuration."""

import os
import re
import sys
import warnings
from importlib.metadata import version as installed_version
from pathlib import Path

project = "fricmb"
author = "The fricmb developers"
copyright = "2026, The fricmb developers"
release = version = installed_version("fricmb")

# Pages solve many small problems: threads of BLAS would cost a finite element page four times its processor time.
for library in ("OPENBLAS", "MKL", "OMP"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

sys.path.insert(0, os.path.dirname(__file__))  # _api, _described, _examples, _layers, _pages, _pictures

import _api  # noqa: E402
import _described  # noqa: E402

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "_made", "jupyter_execute", "reference/_*.md"]  # what an earlier build left is no page
KINDS = "ipynb", "py", "md5", "json", "zip"
exclude_patterns += [f"gallery/{deep}*.{kind}" for deep in ("", "**/") for kind in KINDS]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

# Tutorials are notebooks in Markdown: their code runs here, and what it prints and draws is what the page shows.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
os.environ.pop("MPLBACKEND", None)  # pictures go into the pages

autosummary_generate = True
templates_path = ["_templates"]
autosummary_context = {"shown": _api.shown}  # members that a page shows
autodoc_typehints = "none"  # types stand in the numpydoc sections
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
numpydoc_xref_aliases = _api.type_links(Path(__file__).parent / "reference")
numpydoc_xref_ignore = "all"  # only the names above are links

html_theme = "furo"
html_title = f"fricmb {release}"
MADE = "_made"  # what these pages are made of beside text, written when they are built
os.makedirs(os.path.join(os.path.dirname(__file__), MADE), exist_ok=True)
html_static_path = ["static", MADE]
html_css_files = ["pages.css"]

# the gallery by question, in this order
GROUPS = "stick_slip", "motion", "damping", "shaking", "plane", "squeal", "methods", "paper"
sphinx_gallery_conf = {
    "examples_dirs": ["../examples"],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "subsection_order": [f"../examples/{name}" for name in GROUPS],
    "abort_on_example_error": True,
    "download_all_examples": False,
    "remove_config_comments": True,
    "matplotlib_animations": False,
    "min_reported_time": 1e9,
    "show_memory": False,
}
# The gallery's settings hold objects that do not pickle; only the incremental build cares.
suppress_warnings = ["config.cache"]
warnings.filterwarnings("ignore", message="FigureCanvasAgg is non-interactive")


def keep_bars(app, what, name, obj, options, lines):
    """A magnitude like |F| in a docstring is text, not a substitution; code in ``literals`` stays as it is."""
    for i, line in enumerate(lines):
        pieces = re.split(r"(``.*?``)", line)
        pieces[::2] = [re.sub(r"(?<!\\)\|(\w+)\|", r"\\|\1\\|", piece) for piece in pieces[::2]]
        lines[i] = "".join(pieces)


def benchmark_pages(app):
    """The measured pages, out of the results that were committed."""
    import json
    from functools import partial
    from pathlib import Path

    from fricmb.bench import page, report_body
    from fricmb.bench.stability import stability_body

    here = Path(app.srcdir)
    kept = here / MADE / "benchmark"
    kept.mkdir(parents=True, exist_ok=True)

    def put(name, content, words):
        """A picture or a table of runs as a file of its own: the page stays small."""
        is_picture = name.endswith(".svg")
        file = kept / name.replace(" ", "_").replace(",", "")
        file.write_text(content if is_picture else page(words, [content]), encoding="utf-8")
        url = f"../_static/benchmark/{file.name}"
        shown = f'<img src="{url}" alt="{words}" loading="lazy">' if is_picture else f'<a href="{url}">{words}</a>'
        return f"<p>{shown}</p>"

    for name, body in (("benchmark", partial(report_body, put=put)), ("stability", stability_body)):
        data = here / "benchmark" / f"{'result' if name == 'benchmark' else name}.json"
        html = body(json.loads(data.read_text(encoding="utf-8")))
        (here / "reference" / f"_{name}.html").write_text(html, encoding="utf-8")


def reference_pages(app):
    """The parts of the reference that come out of the code, and what the oracle found, out of committed results."""
    import json
    from pathlib import Path

    import _layers
    import _pages
    import _pictures

    _layers.draw(Path(app.srcdir) / "explanation" / "_layers.svg")
    here = Path(app.srcdir) / "reference"
    found = {
        name: json.loads((here.parent / "benchmark" / f"{name}.json").read_text(encoding="utf-8"))
        for name in ("oracle", "oracle_laws", "oracle_impacts")
    }
    by_hand = json.loads((here.parent / "benchmark" / "impact_error.json").read_text(encoding="utf-8"))
    for name, text in {
        "command_line": _pages.command_line(),
        "models": _pages.model_pages(lambda model: _pictures.write(model, here)),
        "model_parameters": _pages.model_parameters(),
        "law_parameters": _pages.law_parameters(),
        "impact_error": _pages.impact_error(by_hand),
        **{name: _pages.oracle(result) for name, result in found.items()},
    }.items():
        (here / f"_{name}.md").write_text(text, encoding="utf-8")


def leave_out_decisions(app, doctree):
    """Decisions are for contributors: a user's search does not find them."""
    if app.env.docname.startswith("decisions/"):
        app.env.metadata[app.env.docname]["nosearch"] = True


def setup(app):
    app.connect("builder-inited", reference_pages)
    app.connect("builder-inited", benchmark_pages)
    app.connect("doctree-read", _described.check)
    app.connect("doctree-read", leave_out_decisions)
    app.connect("autodoc-process-docstring", keep_bars, priority=400)
    # after numpydoc, so that an example stands below the sections that it makes
    app.connect("autodoc-process-docstring", _api.add_example(_api.Shown(Path(app.srcdir) / MADE)), priority=900)
