"""Examples of finite element models and test data."""

_FE = """
import numpy as np

tie = np.diag(np.r_[np.full(11, 2.0), 1.0]) - np.eye(12, k=1) - np.eye(12, k=-1)
friction = np.diag(np.r_[np.zeros(9), 3.0, 3.0, 3.0])
zero = np.zeros((12, 12))
fe = fm.fe.FEModel(
    M=np.eye(24), K=100.0 * np.block([[tie, zero], [zero, 1.02 * tie]]),
    parts={"KR": np.block([[zero, -friction], [friction, zero]])},
    labels=[(i, dof) for dof in (1, 2) for i in range(1, 13)], name="bars",
)
"""
_TEST = """
import numpy as np

f = np.arange(20.0, 400.0, 0.25)
s = 2j * np.pi * f[:, None]
omega = 2 * np.pi * np.array([50.0, 137.0])


def accelerance(a, b):
    return (s**2 * np.array(a) * np.array(b) / (s**2 + 0.006 * omega * s + omega**2)).sum(axis=1)


shapes = {4: [1.0, -0.6], 9: [-0.5, 0.4]}
frfs = tuple(
    fm.measure.Frf(
        f=f, values=accelerance(shape, shapes[4]), node=node, axis="z", reference=4, reference_axis="z",
        kind="accelerance",
    )
    for node, shape in shapes.items()
)
modes = fm.measure.identify(frfs)
"""
EXAMPLES = {
    "fe.FEModel": _FE + "print(fe)\nprint(fe.check())\n",
    "fe.read": """
import tempfile
from pathlib import Path

import numpy as np

path = Path(tempfile.mkdtemp()) / "model.npz"
np.savez(path, M=np.eye(2), stiff_r=[0, 1, 1], stiff_c=[0, 0, 1], stiff_v=[2.0, -1.0, 1.0])
fe = fm.fe.read(path, names={"M": "M", "K": "stiff"}, units="t-mm-s")
print(fe)
print(fe.frequencies(2))
""",
    "fe.join": """
import numpy as np

spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
left = fm.fe.FEModel(M=np.eye(2), K=spring, labels=[(1, 1), (2, 1)], fixed=[(1, 1)], name="left")
right = fm.fe.FEModel(M=np.eye(2), K=spring, labels=[(2, 1), (3, 1)], name="right")
print(fm.fe.join(left, right))
""",
    "measure.read": """
import tempfile
from pathlib import Path

import numpy as np

t = np.arange(200) * 0.01
path = Path(tempfile.mkdtemp()) / "run.csv"
np.savetxt(path, np.column_stack([t, np.sin(9.0 * t)]), delimiter=",", header="time,force [N]", comments="")
found = fm.measure.read(path)
print(found)
print(found.signals[0].name, found.signals[0].unit, found.signals[0].y.max())
""",
    "measure.identify": _TEST + """
print(modes.hertz, modes.damping_ratios)
casting = fm.ModalBody.from_test("casting", modes, points={"tip": 4, "root": 9}, axes="z")
found = casting.compare(fm.measure.Measured(modes=modes, frfs=frfs), points={"tip": 4, "root": 9})
print(found)
figure = found.plot.responses()
""",
}
SHARED = {"fe.Check": "fe.FEModel"} | dict.fromkeys(
    ["measure.Measured", "measure.TimeSeries"], "measure.read"
) | dict.fromkeys(["measure.Frf", "measure.Modes", "measure.Comparison"], "measure.identify")
