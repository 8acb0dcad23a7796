"""What fricmb.bench ships of the certified references; run as a script it writes the files anew."""

import importlib.util
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
_spec = importlib.util.spec_from_file_location("reference", ROOT / "tests" / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)

NAMES = (
    "p1_1", "p1_2", "p1_5", "p2_a", "p2_b", "p2_s", "p2_sb", "p3_forced_w0.5_f0.2",
    "p3_forced_w0.8_f0.2", "p3_forced_w1.5_f0.2", "p4_vdr0.1", "p5_a", "p5_b", "p5_d", "p5_e", "p6", "chain10",
    "chain100",
)  # fmt: skip
STICK, SLIP, REVERSAL = 0, 1, 2


def kinds(ref):
    """(contact, kind) of every transition."""
    if "type_event" in ref:
        return np.zeros(len(ref["t_event"]), int), ref["type_event"].astype(int)
    if "before" in ref or "mode_before" in ref:
        before, after = (ref.get(key, ref.get(f"mode_{key}")) for key in ("before", "after"))
        kind = np.where(after == 0, STICK, np.where(before == 0, SLIP, REVERSAL))
        return ref.get("contact_event", np.zeros(len(kind), int)).astype(int), kind.astype(int)
    return np.zeros(len(ref["t_event"]), int), np.full(len(ref["t_event"]), STICK)


def growth(name, ref):
    """Growth of a relative error of the initial state, over time or its largest."""
    if "growth" in ref:
        return np.maximum.accumulate(np.maximum(ref["growth"], 1.0))
    if name.startswith("p1"):
        size = np.abs(np.concatenate([ref["q"], ref["v"]], axis=1)).max(axis=0)
        matrix = np.array(ref["info"]["sensitivity"]["max_over_time"])
        return np.array([(matrix * size[None, :] / size[:, None]).max()])
    if name.startswith("p5"):
        return np.array([ref["info"]["sensitivity"]["max"]])
    return np.ones(1)


def packed(name):
    """The arrays of the data file of that name."""
    if name.startswith("chain"):
        ref = reference.load("chain")
        q = ref["x" + name[5:]].T
        return {"t": ref["t"], "q": q, "growth": np.ones(1), "digits": np.array(1e-13)}
    ref = reference.load(name)
    arrays = {"t": ref["t"], "q": ref["q"].T, "v": ref["v"].T, "growth": growth(name, ref), "digits": np.array(1e-15)}
    if "F" in ref:
        arrays["F"] = ref["F"].T
    if "t_event" in ref:
        contact, kind = kinds(ref)
        arrays |= {"t_event": ref["t_event"], "contact_event": contact, "kind_event": kind}
    return arrays


if __name__ == "__main__":
    for name in NAMES:
        np.savez_compressed(ROOT / "fricmb" / "bench" / "data" / f"{name}.npz", **packed(name))
