"""Examples of ``fm.space``, one for each public name."""

_DOWN = 'weight = fm.Gravity("weight", acceleration={"z": -9.81})\n'
_BODY = (
    """
ends = {"top": (0, 0, 0.3), "low": (0, 0, -0.3)}
arm = fm.space.RigidBody("arm", mass=1.0, inertia=(0.03, 0.03, 0.01), points=ends, position=(0.3, 0, 0),
                         orientation=fm.space.turned(axis=(0, 1, 0), angle=-1.5707963267948966))
"""
    + _DOWN
)
_PICTURE = """
figure, ax = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
"""

_AXLE = (
    "import matplotlib.pyplot as plt\nimport numpy as np\n"
    'axle = fm.space.Rotor("axle", mass=1250.0, inertia_across=700.0, inertia_axial=110.0, position=(0, 0.005, 0.45),\n'
    '                      axis=(0, 1, 0), spin=120.0 / 0.45, stations={"left": 0.75, "right": -0.75})\n'
    'spring = fm.Spring("across", axle, axis="y", stiffness=3e5)\n' + _DOWN
)
_WHEELS = """
wheels = [
    fm.space.WheelRail(side, axle.station(side), through=(0, y, 0), rolling_radius=0.45, conicity=0.05,
                       speed=120.0, friction=creep)
    for side, y in (("left", 0.75), ("right", -0.75))
]
"""


def _run(parts: str, shown: str, t_end: float = 1.0) -> str:
    """A scene of these parts, run, and what is printed of it."""
    return f'sol = fm.simulate(fm.Scene("in space", [{parts}]), t_end={t_end}, rtol=1e-6)\nprint({shown})\n'


def _hung(joint: str) -> str:
    """The arm on a joint."""
    return _BODY + joint + "\n" + _run("arm, joint, weight", 'sol["arm.omega"][:, -1].round(4)')


EXAMPLES = {
    "space.RigidBody": "import matplotlib.pyplot as plt\n"
    'book = fm.space.RigidBody("book", mass=1.0, inertia=(1.0, 2.0, 3.0), angular_velocity=(0.1, 2.0, 0.05))\n'
    + _run("book", 'sol["book.rotation"][:, :, -1].round(4)', 40.0)
    + _PICTURE
    + 'ax.plot(sol.t, sol["book.omega"].T)\nax.set(xlabel="time", ylabel="angular velocity")\n',
    "space.Rotor": "import matplotlib.pyplot as plt\nimport numpy as np\n"
    "axis = np.array([np.sin(0.4), 0.0, np.cos(0.4)])\n"
    'top = fm.space.Rotor("top", mass=0.5, inertia_across=2e-4, inertia_axial=2.5e-4, position=0.04 * axis,\n'
    '                     axis=axis, spin=120.0, stations={"tip": -0.04})\n'
    'tip = fm.space.Spherical("tip", top.station("tip"))\n'
    + _DOWN
    + _run("top, tip, weight", 'sol["top.axis"][:, -1].round(6)', 1.5)
    + _PICTURE
    + 'seen = sol.at(np.linspace(0.0, 1.5, 1500))\nax.plot(seen["top.axis_x"], seen["top.axis_y"])\n'
    + 'ax.set(xlabel="axis, x", ylabel="axis, y", aspect="equal")\n',
    "space.Ball": 'ball = fm.space.Ball("ball", mass=0.17, radius=0.0286, velocity=(1, 0, 0))\n'
    + _run("ball", 'sol["ball.x"][-1], sol["ball.omega"][:, -1]'),
    "space.Torque": 'wheel = fm.space.Rotor("wheel", mass=1.0, inertia_across=0.1, inertia_axial=0.2, spin=100.0)\n'
    'torque = fm.space.Torque("push", wheel, axis=(1, 0, 0), value=2.0)\n'
    + _run("wheel, torque", 'sol["wheel.axis"][:, -1].round(4)'),
    "space.OnPlane": "import matplotlib.pyplot as plt\nimport numpy as np\n"
    'ball = fm.space.Ball("ball", mass=0.17, radius=0.0286, position=(0, 0, 0.0286), velocity=(1.5, 0, 0),\n'
    "                     angular_velocity=(20.0, -30.0, 50.0))\n"
    'cloth = fm.space.OnPlane("cloth", ball, normal=(0, 0, 1), friction=fm.laws.Coulomb(mu_s=0.2))\n'
    + _DOWN
    + _run("ball, cloth, weight", "sol.events[0]")
    + _PICTURE
    + 'seen = sol.at(np.linspace(0.0, 1.0, 400))\nax.plot(seen.t, np.hypot(*seen.relative_velocity("cloth")))\n'
    + 'ax.set(xlabel="time", ylabel="slip speed")\n',
    "space.InCylinder": "import matplotlib.pyplot as plt\nimport numpy as np\n"
    'ball = fm.space.Ball("ball", mass=0.05, radius=0.02, position=(0.13, 0, 0), velocity=(0, 1.17, 0.1),\n'
    "                     angular_velocity=(0, 5.0, -58.5))\n"
    'tube = fm.space.InCylinder("tube", ball, axis=(0, 0, 1), radius=0.15, friction=fm.laws.Coulomb(mu_s=2.0))\n'
    + _DOWN
    + _run("ball, tube, weight", 'sol["ball.z"].min()', 3.0)
    + _PICTURE
    + 'seen = sol.at(np.linspace(0.0, 3.0, 400))\nax.plot(seen.t, seen["ball.z"])\n'
    + 'ax.set(xlabel="time", ylabel="height")\n',
    "space.Pad": "import matplotlib.pyplot as plt\nimport numpy as np\n"
    'disc = fm.space.Rotor("disc", mass=18.0, inertia_across=0.16, inertia_axial=0.32, angular_velocity=(0, 60, 50))\n'
    'hub = fm.space.Spherical("hub", disc)\n'
    "pads = [\n"
    "    fm.space.Pad(name, disc, at=(0.13, 0, side * 0.01), normal=(0, 0, side), preload=3e3, stiffness=6e6,\n"
    "                 damping=5.0, friction=fm.laws.Coulomb(mu_s=0.4))\n"
    '    for name, side in (("upper", 1), ("lower", -1))\n'
    "]\n"
    + _run("disc, hub, *pads", "[event.kind for event in sol.events[:4]]", 0.005)
    + _PICTURE
    + "seen = sol.at(np.linspace(0.0, 0.005, 600))\n"
    + 'for name in ("upper", "lower"):\n    ax.plot(1e3 * seen.t, seen.normal_force(name) / 1e3, label=name)\n'
    + 'ax.set(xlabel="time, ms", ylabel="normal force, kN")\nax.legend()\n',
    "space.DryFriction": 'wheel = fm.space.Rotor("wheel", mass=1.0, inertia_across=0.1, inertia_axial=0.2, spin=3.0)\n'
    'hub = fm.space.Revolute("hub", wheel, axis=(0, 0, 1))\n'
    'seal = fm.space.DryFriction("seal", wheel, axis=hub, static=0.8, kinetic=0.6)\n'
    + _run("wheel, hub, seal", "sol.events[0]", 2.0),
    "space.DrivenSpin": 'wheel = fm.space.Rotor("wheel", mass=1.0, inertia_across=0.1, inertia_axial=0.2)\n'
    'drive = fm.space.DrivenSpin("drive", wheel, speed=3.0 * fm.t)\n'
    + _run("wheel, drive", 'sol.reaction("drive")[0, -1].round(6)'),
    "space.kalker": "found = fm.space.kalker(a=6e-3, b=5e-3, shear_modulus=8e10, poisson=0.28)\nprint(found)\n",
    "space.WheelRail": _AXLE
    + "creep = fm.space.ShenHedrickElkins(mu=0.3, f11=8e6, f22=7e6, speed=120.0)\n"
    + _WHEELS
    + _run("axle, spring, *wheels, weight", 'sol["axle.y"][-1]')
    + _PICTURE
    + 'seen = sol.at(np.linspace(0.0, 1.0, 400))\nax.plot(seen.t, seen["axle.y"])\n'
    + 'ax.set(xlabel="time", ylabel="displacement")\n',
    "space.LinearCreep": "import matplotlib.pyplot as plt\nimport numpy as np\n"
    "given = {'f11': 8e6, 'f22': 8e6, 'speed': 50.0}\n"
    "laws = [fm.space.LinearCreep(**given), fm.space.ShenHedrickElkins(mu=0.3, **given),\n"
    "        fm.space.Polach(mu=0.3, A=0.4, B=0.6, **given)]\n"
    "slip = np.linspace(0.0, 1.0, 200)\n"
    + _PICTURE
    + "for law in laws:\n"
    "    ax.plot(slip / 50.0, -law.force([slip, 0 * slip], 60e3)[0], label=type(law).__name__)\n"
    'ax.set(xlabel="creepage", ylabel="force, N", ylim=(0, 3e4))\nax.legend()\n'
    "print(laws[1].force([0.1, 0.05], 60e3).round(3))\n",
    "space.turned": "print(fm.space.turned(axis=(0, 0, 1), angle=0.1)[0])\n",
    "space.Spherical": _hung('joint = fm.space.Spherical("joint", arm.point("top"))'),
    "space.Revolute": _hung('joint = fm.space.Revolute("joint", arm.point("top"), axis=(0, 1, 0))'),
    "space.Cylindrical": _hung('joint = fm.space.Cylindrical("joint", arm.point("top"), axis=(0, 1, 1))'),
    "space.Prismatic": _hung('joint = fm.space.Prismatic("joint", arm.point("top"), axis=(0, 1, 1))'),
    "space.Universal": _hung(
        'joint = fm.space.Universal("joint", arm.point("top"), axis_a=(0, 1, 0), axis_b=(0, 0, 1))'
    ),
    "space.Fixed": _hung('joint = fm.space.Fixed("joint", arm.point("top"))'),
    "space.Rod": _hung('joint = fm.space.Rod("joint", arm.point("top"), fm.space.ground_point(0, 0, 1), length=1.0)'),
}
SHARED = {
    "space.ground_point": "space.Rod", "space.KalkerCoefficients": "space.kalker",
    **dict.fromkeys(("space.ShenHedrickElkins", "space.Polach"), "space.LinearCreep"),
}
