"""Error of collocation over ``rtol`` on the certified references: ``python tools/collocation_error.py [out.json]``.

Errors are the largest of all signals and times, each scaled by its signal's largest value, over the growth that the
scene itself has.  Both ways of the integrator: its kernels for one contact (where they take the scene), and any ports.
"""

from __future__ import annotations

import json
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import fricmb as fm
from fricmb.integrate.collocation import Collocation

TOLERANCES = [10.0**-k for k in range(3, 12)]


def main() -> None:
    """Print and write the ratios."""
    root = Path(__file__).parents[1]
    spec = spec_from_file_location("scenes", root / "tests/integrate/collocation/test_general.py")
    tests = module_from_spec(spec)
    spec.loader.exec_module(tests)
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else root / "docs/benchmark/collocation_error.json"
    found = []
    for name, make in tests.SCENES.items():
        reference, scene = tests.reference.load(name), make()
        t = reference["t"]
        for way, method in (("one contact", Collocation()), ("any ports", Collocation(general=True))):
            ratios = []
            for rtol in TOLERANCES:
                sol = fm.simulate(scene, t_end=float(t[-1]), rtol=rtol, t_eval=t, method=method)
                ratios.append(float(f"{tests.compare(reference, sol)[0] / rtol:.1e}"))
            found.append({"scene": name, "way": way, "rtol": TOLERANCES, "error_over_rtol": ratios})
            print(f"{name:20} {way:12}", *(f"{x:7.0e}" for x in ratios), flush=True)
    out.write_text("[\n" + ",\n".join(json.dumps(row) for row in found) + "\n]\n")


if __name__ == "__main__":
    main()
