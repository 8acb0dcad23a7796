"""A made-up modal test of a steel finger, as an analyser would write it.

The finger is clamped at one end, 400 mm long, 30 mm wide, 6 mm thick.  A hammer hits its tip (node 4); accelerometers
are glued on at four nodes, that of node 2 upside down.  Responses are sums over the modes of a slender beam in closed
form, with noise of a thousandth of their size; nothing here knows of fricmb.

Run it (it needs pyuff) to write ``finger.uff.gz`` beside it: points (dataset 15), units (164: millimetres, newtons) and
accelerances (58) in mm/s^2 over N.
"""

import gzip
import tempfile
from pathlib import Path

import numpy as np
import pyuff
from scipy.optimize import brentq

LENGTH, WIDTH, THICK, YOUNG, DENSITY = 0.4, 0.03, 0.006, 2.1e11, 7850.0
NODES = {1: 0.1, 2: 0.2, 3: 0.3, 4: 0.4}
DAMPING = [0.012, 0.009, 0.007, 0.007, 0.007, 0.007]
UPSIDE_DOWN = 2


def modes():
    """Angular frequencies, and shapes of unit modal mass at the nodes."""
    # cos(b) cosh(b) = -1, between multiples of pi
    spans = [(k * np.pi, (k + 1) * np.pi) for k in range(len(DAMPING))]
    b = np.array([brentq(lambda x: np.cos(x) + 1 / np.cosh(x), *span) for span in spans])
    omega = (b / LENGTH) ** 2 * np.sqrt(YOUNG * THICK**2 / (12 * DENSITY))
    s = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    x = b[:, None] * np.array(list(NODES.values())) / LENGTH
    shape = np.cosh(x) - np.cos(x) - s[:, None] * (np.sinh(x) - np.sin(x))
    return omega, shape / np.sqrt(DENSITY * WIDTH * THICK * LENGTH)


if __name__ == "__main__":
    rng = np.random.default_rng(4)
    f = np.arange(10.0, 700.0, 0.5)
    omega, shapes = modes()
    w = 2 * np.pi * f[:, None]
    single = -(w**2) / (omega**2 - w**2 + 2j * np.array(DAMPING) * omega * w)
    with tempfile.TemporaryDirectory() as folder:
        file = pyuff.UFF(f"{folder}/finger.uff")
        numbers = list(NODES)
        zero = [0.0] * 4
        x = [1e3 * at for at in NODES.values()]
        sets = [
            pyuff.prepare_15(node_nums=numbers, def_cs=[0] * 4, disp_cs=[0] * 4, color=[1] * 4, x=x, y=zero, z=zero),
            pyuff.prepare_164(
                units_code=9, units_description="mm (newton)", temp_mode=1, length=1000.0, force=1.0, temp=1.0,
                temp_offset=273.15,
            ),
        ]
        for k, node in enumerate(numbers):
            values = 1e3 * single @ (shapes[:, k] * shapes[:, -1])
            noise = rng.standard_normal((2, f.size))
            values = values + 1e-3 * np.sqrt(np.mean(np.abs(values) ** 2)) * (noise[0] + 1j * noise[1])
            sign = -1 if node == UPSIDE_DOWN else 1
            sets.append(
                pyuff.prepare_58(
                    binary=0, func_type=4, id1=f"node {node}", rsp_node=node, rsp_dir=3 * sign, ref_node=4, ref_dir=3,
                    x=f, data=sign * values, abscissa_spacing=1, abscissa_min=f[0], abscissa_inc=0.5,
                    abscissa_spec_data_type=18, ordinate_spec_data_type=12, orddenom_spec_data_type=13,
                    ordinate_axis_units_lab="mm/s2", orddenom_axis_units_lab="N",
                )
            )
        for one in sets:
            file.write_sets(one, "add")
        data = Path(f"{folder}/finger.uff").read_bytes()
    Path(__file__).with_name("finger.uff.gz").write_bytes(gzip.compress(data, mtime=0))
