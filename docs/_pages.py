"""What the reference can say by itself: the command line from its parser, parameters from signatures and docstrings."""

import argparse
import dataclasses
import inspect
import re
from collections import Counter

from _pictures import STORIES
from numpydoc.docscrape import NumpyDocString

import fricmb as fm
from fricmb.cli._main import parser
from fricmb.models import catalogue

# Dimensions of arguments of models, by what they are called; "" where there is none.
DIMENSIONS = {
    "mass": "mass", "masses": "mass", "support": "mass", "pad_mass": "mass", "lever": "mass", "density": "mass/length",
    "inertia": "mass length^2", "inertia_across": "mass length^2", "inertia_axial": "mass length^2", "reach": "length",
    "arm": "length", "half_gauge": "length", "cylinder_radius": "length", "rise": "length/time",
    "yaw_stiffness": "force length/rad", "f11": "force", "f22": "force",
    "tip_radius": "length", "length": "length", "radius": "length", "crank": "length", "rod": "length",
    "coupler": "length", "rocker": "length", "half": "length", "half_width": "length", "half_height": "length",
    "height": "length", "pin": "length", "bump": "length", "eps": "length",
    "x0": "length", "position": "length", "kick": "length", "angle": "rad", "angles": "rad",
    "stiffness": "force/length", "coupling": "force/length", "ground": "force/length", "k1": "force/length",
    "k2": "force/length", "k3": "force/length", "pad_stiffness": "force/length",
    "damping": "force time/length", "gravity": "length/time^2", "normal_force": "force", "friction": "force",
    "amplitude": "force", "preload": "force", "gap": "rad", "load": "force", "pull": "force", "pretension": "force",
    "torque": "force length",
    "mu_k_N": "force", "mu_s_N": "force", "speed": "length/time", "belt": "length/time", "velocity": "length/time",
    "v0": "length/time", "u0": "length/time", "table": "length/time", "rotor_velocity": "modal",
    "frequency": "rad/time", "spin": "rad/time", "angular_velocity": "rad/time", "rates": "rad/time",
    "turning": "rad/time", "thickness": "length", "bearing_stiffness": "force length/rad",
    "bearing_damping": "force length time/rad", "guide_stiffness": "force/length",
    "guide_damping": "force time/length", "waviness": "length", "direction": "rad", "rate": "rad/time",
    "sleeve_mass": "mass", "sleeve_inertia": "mass length^2", "loose_mass": "mass", "force": "force",
}  # fmt: skip
NUMBERS = [
    "mu", "mu_s", "mu_k", "delta", "Omega1", "Omega2", "mass_ratio", "ratio", "pad_damping", "rotor_damping",
    "damping_ratio", "split", "modal_mass", "case", "n", "n_pad_modes", "n_rotor_modes", "n_contacts",
    "nodal_diameters", "law", "laws", "pressure", "modes", "conicity", "slope",
    "restitution", "lifted",
]  # fmt: skip
DIMENSIONS |= dict.fromkeys(NUMBERS, "")
# Where a model means something else by a name.
OTHERWISE = {
    ("four_bar", "ground"): "length",
    ("four_bar", "speed"): "rad/time",
    ("four_bar", "friction"): "",
    ("slider_crank", "speed"): "rad/time",
    ("slider_crank", "friction"): "",
    ("andrews", "friction"): "",
    ("band_brake", "speed"): "rad/time",
    ("belt_drive", "speed"): "rad/time",
    ("belt_drive", "load"): "force length",
    ("drive_train", "speed"): "rad/time",
    ("gear_rattle", "amplitude"): "rad",
    ("oscillating_table", "amplitude"): "length",
    ("vibrating_incline", "amplitude"): "length",
    ("vibrating_incline", "slope"): "rad",
    ("impact_damper", "gap"): "length",
    ("newtons_cradle", "gap"): "length",
    ("woodpecker", "stiffness"): "force length/rad",
    ("drive_train", "stiffness"): "force length/rad",
    ("drive_train", "damping"): "force length time/rad",
    ("sprag_slip", "stiffness"): "force length/rad",
    ("wobbling_disc_brake", "speed"): "rad/time",
    ("wobbling_disc_brake", "kick"): "rad/time",
}
# The dimensions of parameters of laws; what is not named is a number without one.
LAW_DIMENSIONS = {
    **dict.fromkeys(["v_s", "v_t", "v_reg", "v_0", "v_1", "v_m", "v_w", "v_band"], "length/time"),
    **dict.fromkeys(["sigma0", "stiffness"], "1/length"),
    **dict.fromkeys(
        ["sigma1", "sigma2", "viscous", "damping", "delta", "decay", "g2", "g3", "g5", "g6"], "time/length"
    ),
    **dict.fromkeys(["distance", "L"], "length"),
    "tau_dwell": "time",
    "attraction": "1/time",
    "N_0": "force",
}
SI = {"mass": "kg", "length": "m", "time": "s", "force": "N"}


def cell(text) -> str:
    """Text of a docstring in a cell of a table."""
    return re.sub(r"(?<!\\)\|", r"\\|", " ".join(str(text).split())).replace("``", "`").replace("<", "&lt;")


def table(head, rows) -> list[str]:
    """A table, and the empty line behind it."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return [*lines, *("| " + " | ".join(row) + " |" for row in rows), ""]


# -- the command line -----------------------------------------------------------------------------------------------
def command_line() -> str:
    """Every command with its usage and options."""
    top = parser()
    (commands,) = (action for action in top._actions if isinstance(action, argparse._SubParsersAction))
    lines = []
    for name, sub in commands.choices.items():
        usage = " ".join(sub.format_usage().split()).removeprefix("usage: ")
        lines += [f"## `fricmb {name}`", "", sub.description, "", "```text", *folded(usage), "```", ""]
        actions = [action for action in sub._actions if not isinstance(action, argparse._HelpAction)]
        if actions:
            lines += table(("argument", ""), [(f"`{call(a)}`", cell(told(a))) for a in actions])
    return "\n".join(lines)


def folded(text: str, width: int = 72) -> list[str]:
    """In lines that a phone shows."""
    import textwrap

    return textwrap.wrap(text, width, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)


def call(action) -> str:
    """An option or argument as it is typed."""
    if not action.option_strings:
        return action.metavar or action.dest.upper()
    value = "" if action.nargs == 0 else f" {action.metavar or action.dest.upper()}"
    return "/".join(action.option_strings) + value


def told(action) -> str:
    """What the help says, and the choices."""
    text = (action.help or "") % {"default": action.default, "prog": "fricmb"}
    return text + (f" ({', '.join(action.choices)})" if action.choices else "")


# -- models ---------------------------------------------------------------------------------------------------------
def documented(held) -> dict[str, str]:
    """What the docstring says of each parameter."""
    found = {}
    for entry in NumpyDocString(inspect.getdoc(held))["Parameters"]:
        for name in entry.name.split(","):
            found[name.strip()] = " ".join(entry.desc) or "see the model"
    return found


def unit(model, name: str) -> str:
    """SI where the model has them, else the dimension: such a model takes any consistent units."""
    if name not in DIMENSIONS:
        raise KeyError(f"DIMENSIONS in docs/_pages.py has no {name!r}, an argument of the model {model.name}")
    dimension = OTHERWISE.get((model.name, name), DIMENSIONS[name])
    if not dimension or model.units.time == "1":
        return dimension
    return re.sub(r"[a-z]+", lambda word: SI.get(word[0], word[0]), dimension).replace("^2", "²")


def model_pages(pictures) -> str:
    """A section for each model; ``pictures(model)`` gives the names of its scheme and its run."""
    lines = []
    for model in catalogue.values():
        scheme, run = pictures(model)
        lines += [
            f"## {model.name}", "",
            model.summary + f" Standard run: to t = {model.t_end:g}"
            + (" s" if model.units.time == "s" else "") + f".{_story(model)}"
            + f" {{func}}`API <fricmb.models.{model.name}>`", "",
            f"```{{image}} {scheme}", f":alt: Scheme of {model.name}: bodies, springs, contacts or joints",
            ":class: half", "```",
            f"```{{image}} {run}", f":alt: Velocities in the standard run of {model.name} over time",
            ":class: half", "```", "",
            f"`fricmb run {model.name}`, arguments by `--set`: {{ref}}`table <parameters-{model.name}>`", "",
        ]  # fmt: skip
    return "\n".join(lines)


def _story(model) -> str:
    """What the picture of a run shows where it is no standard run."""
    if model.name not in STORIES:
        return ""
    t_end, arguments = STORIES[model.name]
    return f" The picture: {', '.join(f'{k}={v:g}' for k, v in arguments.items())}, to t = {t_end:g} s."


def model_parameters() -> str:
    """Arguments of every model, and the parameters of its scene."""
    lines = []
    for model in catalogue.values():
        said = documented(model.build)
        rows = []
        for argument in inspect.signature(model.build).parameters.values():
            default = "" if argument.default is inspect.Parameter.empty else f"`{argument.default!r}`"
            rows.append((f"`{argument.name}`", default, unit(model, argument.name), cell(said[argument.name])))
        names = sorted(model.build().parameters)
        shown = ", ".join(f"`{name}`" for name in names[:12])
        more = f" and {len(names) - 12} more (`print(scene.parameters)`)" if len(names) > 12 else ""
        lines += [f"(parameters-{model.name})=", f"## {model.name}", "", model.summary, ""]
        lines += table(("argument", "default", "unit", "meaning and range"), rows)
        lines += [f"Parameters of the scene: {shown}{more}.", ""]
    return "\n".join(lines)


# -- laws -----------------------------------------------------------------------------------------------------------
def law_parameters() -> str:
    """Parameters of every law, with a typical value."""
    lines = []
    for name in fm.laws.names:
        kind = getattr(fm.laws, name)
        said, law = documented(kind), kind.example()
        rows = [
            (f"`{f.name}`", f"`{cell(repr(getattr(law, f.name)))}`", dimension(law, f.name), cell(said[f.name]))
            for f in dataclasses.fields(kind)
        ]
        summary = cell(inspect.getdoc(kind).partition("\n")[0])
        lines += [f"## {name}", "", f"{summary} {{class}}`API <fricmb.laws.{name}>`", ""]
        lines += table(("parameter", "example", "dimension", "meaning and range"), rows)
    return "\n".join(lines)


def dimension(law, name: str) -> str:
    """Of a parameter; 1 for a number, empty for what is none."""
    value = getattr(law, name)
    return "" if isinstance(value, str | fm.FrictionLaw) else law_dimension(type(law).__name__, name)


def law_dimension(law: str, name: str) -> str:
    """By the name, but for a table's speeds and the tables' own names."""
    if (law, name) == ("Tabulated", "speed"):
        return "length/time"
    return LAW_DIMENSIONS.get(name, "1")


# -- the oracle -----------------------------------------------------------------------------------------------------
#: More failed runs of a method than this are counted on the page, not listed.
MOST_LISTED = 60


def oracle(result) -> str:
    """Verdicts by method of a run of ``python -m tests.oracle``, then every run that failed."""
    about = result["about"]
    kinds = ("right", "noted", "wrong", "stopped", "late", "crashed", "refused", "marginal")
    counted = {
        kind: ", ".join(f"{n} {outcome}" for outcome, n in counts.items() if n)
        for kind, counts in result["scenes"].items()
    }
    lines = [
        f"{about['date']}, `rtol` {about['rtol']:g}, {about['minutes']:g} minutes, first seed {about['seed']}; scenes: "
        + "; ".join(f"{kind}: {text}" for kind, text in counted.items()) + ".", "",
    ]  # fmt: skip
    rows = [
        (f"`{name}`", *(str(row.get(kind, 0)) for kind in kinds), digits(row["worst"]), digits(row["percentile_99"]),
         str(row["wrong_transitions"]))
        for name, row in result["methods"].items()
    ]  # fmt: skip
    lines += table(("method", *kinds, "worst", "99 %", "transitions wrong"), rows)
    by_method = Counter(found["method"] for found in result["failures"])
    failed = [
        (where(found), f"`{found['method']}`", found["verdict"], digits(found["ratio"]), cell(found["why"]))
        for found in result["failures"]
        if by_method[found["method"]] <= MOST_LISTED
    ]
    if failed:
        lines += ["Runs that failed:", "", *table(("scene", "method", "verdict", "error", "why"), failed)]
    for name, count in by_method.items():
        if count > MOST_LISTED:
            lines += [f"The {count} of `{name}` stand in `docs/benchmark/oracle.json`.", ""]
    return "\n".join(lines)


def impact_error(rows) -> str:
    """Errors and times of ``tools/impact_error.py`` at one tolerance and of Siconos' steps, a line for each scene."""
    at = {(row["scene"], row["way"]): row for row in rows if row.get("rtol") == 1e-8 or row.get("h") == 1e-4}
    ways = ("fricmb", "by hand", "Siconos")
    lines = [
        (scene, *(digits(at.get((scene, way), {}).get(what)) for what in ("error", "ms") for way in ways))
        for scene in dict.fromkeys(row["scene"] for row in rows)
    ]
    return "\n".join(table(("scene", *(f"{what}, {way}" for what in ("error", "ms") for way in ways)), lines))


def digits(number) -> str:
    """Two digits; a dash where there is none."""
    return "-" if number is None else f"{number:.2g}"


def where(found) -> str:
    """Law and situation, or kind and seed."""
    return f"{found['law']}, {found['situation']}" if "law" in found else f"{found['kind']} {found['seed']}"
