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
EXAMPLES = {
    "fe.FEModel": _FE + "print(fe)\nprint(fe.check())\n",
    "fe.read": """
import numpy as np

np.savez("model.npz", M=np.eye(2), stiff_r=[0, 1, 1], stiff_c=[0, 0, 1], stiff_v=[2.0, -1.0, 1.0])
fe = fm.fe.read("model.npz", names={"M": "M", "K": "stiff"}, units="t-mm-s")
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
}
SHARED = {"fe.Check": "fe.FEModel"}
