"""Damage saved solutions at random and read them: either an error in fricmb's own words, or exactly what was saved.

    python tools/fuzz_files.py --count 10000 --seed 1

Two kinds of damage.  To the *bytes* of the file: flipped bits, cuts, blocks of zeros or noise, parts swapped or
doubled, pieces of another file; such a file must be refused, or give the same solution (where bytes were hit that mean
nothing).  To the *contents*: numbers, words and lists of the JSON, arrays of other lengths, types and values, entries
left out, the digests made again, as somebody would who means harm; such a file must be refused, or be consistent, and
open its scene and its dense output or refuse them.  Code that runs, an import from outside of fricmb, and a process
that starts meanwhile are failures.
"""

from __future__ import annotations

import argparse
import collections
import copy
import io
import json
import random
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import fricmb as fm
from fricmb.solution._files import _digest

#: Events of the interpreter that reading must not bring about.
FORBIDDEN = ("os.system", "subprocess.Popen", "os.exec", "os.posix_spawn", "os.fork", "pickle.find_class", "exec")
#: Words put into the JSON.
WORDS = ["object", "array", "formula", "os:system", "builtins:eval", "subprocess:Popen", "fricmb.cli:main", "Pow", ""]
#: Other values put there.
VALUES = [None, -1, 0, 2**70, 1e308, True, [], {}, [[]], ["object", 0], ["array", "float64", 0, [1], "C"]]


class Watch:
    """Notes what the interpreter does while files are read."""

    def __init__(self) -> None:
        self.on = False
        self.seen: list[str] = []
        sys.addaudithook(self._hook)

    def _hook(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.on:
            return
        if event.startswith(FORBIDDEN) or (event == "import" and not str(arguments[0]).startswith("fricmb.")):
            self.seen.append(f"{event} {arguments[:1]!r}")


def damage_bytes(data: bytes, other: bytes, rng: random.Random) -> bytes:
    """The file with some of its bytes wrong."""
    held = bytearray(data)
    at, to = sorted(rng.randrange(len(held)) for _ in range(2))
    to = min(to, at + rng.choice((1, 4, 64, 4096)))
    how = rng.randrange(9)
    if how <= 2:
        for _ in range(rng.choice((1, 1, 2, 20))):
            held[rng.randrange(len(held))] ^= 1 << rng.randrange(8)
    elif how == 3:
        del held[at:]
    elif how == 4:
        held[at:to] = bytes(to - at)
    elif how == 5:
        held[at:to] = rng.randbytes(to - at)
    elif how == 6:
        del held[at:to]
    elif how == 7:
        held[at:at] = held[at:to]
    else:
        held[at:to] = other[at:to]
    return bytes(held)


def damage_content(entries: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """The entries with one thing wrong, and digests that say it is right."""
    held = dict(entries)
    about = json.loads(str(held["about"]))
    name = rng.choice([name for name in held if name != "digest"])
    if name == "about":
        about = mutate(about, rng)
    elif name == "run" and rng.random() < 0.9:
        text = text_of(mutate(json.loads(held["run"].tobytes()), rng))
        held["run"] = np.frombuffer(text.encode(), dtype=np.uint8)
    else:
        held = damage_array(held, name, rng)
    if isinstance(about, dict):
        about["digests"] = {name: _digest(value) for name, value in held.items() if name not in ("about", "digest")}
    held["about"] = np.array(text_of(about))
    held["digest"] = np.array(_digest(held["about"]))
    return held


def damage_array(held: dict[str, Any], name: str, rng: random.Random) -> dict[str, Any]:
    """One entry with another length, type, order or value, or none at all."""
    array = np.array(held[name])
    how = rng.randrange(6)
    if how == 0:
        return {key: value for key, value in held.items() if key != name}
    if how == 1 and array.size and array.dtype.kind == "f":
        array.flat[rng.randrange(array.size)] = rng.choice((np.nan, np.inf, -1e300, 1e300, 0.0))
    elif how == 2 and array.ndim:
        array = array[..., : rng.randrange(array.shape[-1] + 1)]
    elif how == 3:
        array = array.astype(rng.choice(("float32", "int64", "U8"))) if array.dtype.kind in "fi" else array.astype("S")
    elif how == 4:
        array = array[None]
    elif array.ndim:
        array = array[..., ::-1]
    return held | {name: array}


def mutate(tree: Any, rng: random.Random) -> Any:
    """One value of the JSON replaced, left out, doubled or moved."""
    places = [(tree, key) for key in (tree if isinstance(tree, dict) else range(len(tree)))]
    while True:
        holder, key = rng.choice(places)
        inner = holder[key]
        if not isinstance(inner, dict | list) or not inner or rng.random() < 0.15:
            break
        places = [(inner, k) for k in (inner if isinstance(inner, dict) else range(len(inner)))]
    how = rng.randrange(6)
    if how == 0:
        del holder[key]
    elif how == 1 and isinstance(holder, list):
        holder.insert(key, inner)
    elif how == 2:
        holder[key] = rng.choice(WORDS)
    elif how == 3:
        holder[key] = copy.deepcopy(rng.choice(VALUES))
    elif how == 4:
        holder[key] = "deep"
    else:
        holder[key] = inner * -2 if isinstance(inner, int | float) else str(inner)
    return tree


def text_of(tree: Any) -> str:
    """JSON; the word "deep" becomes lists in lists, deeper than Python can write them."""
    return json.dumps(tree).replace('"deep"', '["tuple",' * 3000 + "1" + "]" * 3000)


def same(a: fm.Solution, b: fm.Solution) -> bool:
    """Whether two solutions hold the same."""
    arrays = all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("t", "q", "v"))
    return arrays and a.events == b.events and a.stats == b.stats and a.scene == b.scene


def samples(folder: Path) -> list[Path]:
    """Files of a few scenes: formulas, points, law states, modes, a joint."""
    scenes = {
        "brake": (fm.models.brake4dof(), 2.0),
        "flutter": (fm.models.minimal_flutter(), 0.5),
        "oscillator": (fm.models.friction_oscillator(), 1.0),
        "pendulum": (fm.models.dry_pendulum(), 0.1),
        "chain": (fm.models.stick_slip_chain(n=3), 0.5),
        "doublet": (fm.models.rotor_doublet(), 0.05),
        "axis": (fm.models.car_axis(), 0.01),
    }
    paths = []
    for name, (scene, t_end) in scenes.items():
        path = folder / f"{name}.npz"
        fm.simulate(scene, t_end=t_end, rtol=1e-4).save(path)
        paths.append(path)
    return paths


def fuzz(count: int, seed: int, *, say: Callable[[str], None] = print) -> collections.Counter[str]:
    """Read ``count`` damaged files; AssertionError for the first that is not refused in order."""
    found: collections.Counter[str] = collections.Counter()
    watch = Watch()
    with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        folder = Path(name)
        paths = samples(folder)
        files = {path: path.read_bytes() for path in paths}
        whole = {path: fm.Solution.load(path) for path in paths}
        for sol in whole.values():
            _ = sol.scene, sol.end
        entries = {}
        for path in paths:
            with np.load(path, allow_pickle=False) as data:
                entries[path] = dict(data)
        target = folder / "damaged.npz"
        for i in range(count):
            rng = random.Random(f"{seed} {i}")
            path = rng.choice(paths)
            bytewise = rng.random() < 0.5
            if bytewise:
                data = damage_bytes(files[path], files[rng.choice(paths)], rng)
            else:
                stream = io.BytesIO()
                np.savez(stream, **damage_content(entries[path], rng))
                data = stream.getvalue()
            target.write_bytes(data)
            watch.on = True
            try:
                found[one(target, whole[path], bytewise)] += 1
            except Exception as error:
                what = f"{type(error).__name__}: {error}"
                raise AssertionError(f"file {i} of seed {seed} ({path.name}): {what}") from error
            finally:
                watch.on = False
            assert not watch.seen, f"file {i} of seed {seed}: {watch.seen}"
            if (i + 1) % 1000 == 0:
                say(f"{i + 1}: {dict(found)}")
    return found


def one(target: Path, whole: fm.Solution, bytewise: bool) -> str:
    """What reading a damaged file comes to."""
    try:
        sol = fm.Solution.load(target)
    except fm.FricmbError as error:
        return named("refused", target, error)
    if bytewise:
        assert same(sol, whole), "read without a word, and is not what was saved"
        return "bytes that mean nothing"
    _ = sol.q, sol.v, sol.events, sol.energy.residual, sol.summary()
    assert np.isfinite(sol.q).all()
    assert np.isfinite(sol.t).all()
    try:
        _ = sol.scene
        _ = sol(0.5 * (sol.t_start + sol.t_end)), sol.end
    except fm.IntegrationError:
        return "not finite between its ends, and says so"
    except fm.FricmbError as error:
        return named("scene or dense output refused", target, error)
    return "another file that is sound"


def named(outcome: str, target: Path, error: Exception) -> str:
    """The outcome, once the message is seen to name the file."""
    assert str(target) in str(error), f"the message does not name the file: {error}"
    return outcome


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(dict(fuzz(options.count, options.seed)))


if __name__ == "__main__":
    main()
