"""An example of every public name of the Python interface; the tests run each, the pages show what it prints.

What an example leaves in ``figure`` is its picture.  Names that belong together share one.
"""

import _examples_fe
import _examples_space

import fricmb as fm
from fricmb.models import catalogue

_BELT = """
block = fm.Body("block", mass=1.0)
belt = fm.Driven("belt", velocity={"x": 0.2})
spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
sole = fm.Contact("sole", block, belt, law=fm.laws.Coulomb(mu_s=1.0, mu_k=0.5), normal_force=1.0)
scene = fm.Scene("block on a belt", [block, belt, spring, sole])
"""
_RUN = "sol = fm.simulate(fm.models.belt_oscillator(), t_end=40.0, rtol=1e-8)\n"
_BRAKE = 'sol = fm.simulate(fm.models.brake4dof("2"), t_end=100.0, rtol=1e-6)\n'
_SPECTRUM = _BRAKE + 'signal = fm.analysis.uniform(sol, "pad.y", dt=0.05)\n'
_FALLING = """
law = fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.1, viscous=0.2)
scene = fm.models.belt_oscillator(law=law, belt=0.2)
"""
_MODES = _FALLING + """
modes = fm.analysis.complex_eigenvalues(scene, over="belt.velocity.x", values=[0.05, 0.1, 0.2, 0.4, 0.8])
"""
_CYCLE = """
law = fm.laws.HyperbolicStribeck(mu_s=1.0, mu_k=0.0, delta=3.0)
scene = fm.models.belt_oscillator(belt=2.0, damping=0.1, law=law)
cycle = fm.analysis.limit_cycle(scene)
"""
_PENDULUM = """
ends = {"pin": (-0.5, 0.0), "tip": (0.5, 0.0)}
arm = fm.RigidBody("arm", mass=1.0, inertia=0.1, position=(0.5, 0.0), points=ends)
weight = fm.Gravity("weight", acceleration={"y": -9.81})
"""
_DISC = 'disc = fm.RigidBody("disc", mass=1.0, inertia=0.02, angular_velocity=20.0)\n'


def _mechanism(parts: str, shown: str, t_end: float = 2.0, *, before: str = _PENDULUM, name: str = "mechanism") -> str:
    """A mechanism that runs, and a picture of one motion of it."""
    return before + (
        f'scene = fm.Scene("{name}", [{parts}])\n'
        f"sol = fm.simulate(scene, t_end={t_end}, rtol=1e-6)\n"
        f"print({shown}[-1])\n"
    )


def _swing(joint: str, t_end: float = 2.0, before: str = _PENDULUM) -> str:
    code = _mechanism(f"arm, weight,\n    {joint}", 'sol["arm.angle"]', t_end, before=before)
    return code + "figure = scene.draw()\n"


EXAMPLES = {
    "Scene": _BELT + 'print(scene.parameters)\nprint(scene.with_parameters({"spring.stiffness": 2.0}).plan())\n'
             'for a, b, name in scene.graph().edges(keys=True):\n    print(f"{name}: {a} and {b}")\n',
    "Body": 'puck = fm.Body("puck", mass=0.2, axes="xy", velocity={"x": 1.5, "y": 0.5})\n'
            "floor = fm.Contact(\"floor\", puck, law=fm.laws.Coulomb(mu_s=0.2), normal_force=0.2 * 9.81)\n"
            'sol = fm.simulate(fm.Scene("puck", [puck, floor]), t_end=1.0)\n'
            'print(sol.events[0], sol["puck.x"][-1])\n',
    "ModalBody": """
string = fm.ModalBody("string", frequencies=[3.0, 6.0], damping_ratios=0.01, shapes={"bow": [[0.6, 1.0]]})
bow = fm.Driven("bow", velocity={"x": 0.3})
law = fm.laws.HyperbolicStribeck(mu_s=0.8, mu_k=0.3, delta=5.0)
hair = fm.Contact("hair", string.point("bow"), bow, law=law, normal_force=1.0)
sol = fm.simulate(fm.Scene("string", [string, bow, hair]), t_end=20.0)
print(len(sol.events), sol["string.bow.x"][-1])
figure = sol.plot.velocities(["string.mode1", "string.mode2"])
""",
    "Driven": """
import sympy

block = fm.Body("block", mass=1.0)
table = fm.Driven("table", velocity={"x": sympy.cos(1.5 * fm.t)})
sole = fm.Contact("sole", block, table, law=fm.laws.Coulomb(mu_s=1.0), normal_force=1.0)
sol = fm.simulate(fm.Scene("shaken", [block, table, sole]), t_end=10.0)
print(sol.time_share("sole", 0))  # how much of it the block sticks
figure = sol.plot.velocities(["block.x"])
""",
    "Spring": _BELT + "sol = fm.simulate(scene, t_end=20.0)\nprint(sol.events.of(kind='slip')[0])  # torn off\n",
    "Damper": 'cart = fm.Body("cart", mass=1.0, velocity={"x": 1.0})\n'
              'brake = fm.Damper("brake", cart, axis="x", damping=0.5)\n'
              'sol = fm.simulate(fm.Scene("cart", [cart, brake]), t_end=2.0)\n'
              'print(sol.velocity("cart.x")[-1])  # exp(-1)\n',
    "PointSpring": 'bob = fm.Body("bob", mass=1.0, axes="xy", position={"x": 1.2})\n'
                   'cord = fm.PointSpring("cord", bob, stiffness=50.0, length=1.0)\n'
                   'loss = fm.PointDamper("loss", bob, damping=0.5)\n'
                   'sol = fm.simulate(fm.Scene("bob", [bob, cord, loss]), t_end=5.0)\n'
                   'print(sol["bob.x"][-1])\n',
    "Force": 'block = fm.Body("block", mass=1.0)\n'
             'push = fm.Force("push", block, axis="x", value=0.5 * fm.t - 0.1 * fm.speed("block.x"))\n'
             'floor = fm.Contact("floor", block, law=fm.laws.Coulomb(mu_s=1.0), normal_force=1.0)\n'
             'sol = fm.simulate(fm.Scene("pushed", [block, push, floor]), t_end=4.0)\n'
             "print(sol.events[0])  # at 2, where the push is 1\n",
    "MatrixElement": 'a, b = fm.Body("a", mass=1.0, velocity={"x": 1.0}), fm.Body("b", mass=1.0)\n'
                     'link = fm.MatrixElement("link", ["a.x", "b.x"], K=[[2.0, -1.0], [-1.0, 2.0]])\n'
                     'sol = fm.simulate(fm.Scene("two", [a, b, link]), t_end=5.0)\n'
                     'print(sol["a.x"][-1], sol["b.x"][-1])\n',
    "Element": """
from dataclasses import dataclass

from fricmb.scene import direction


@dataclass(frozen=True, kw_only=True)
class Magnet(fm.Element):
    a: fm.Body
    b: object = fm.GROUND
    strength: float

    def local_coordinates(self):
        return (direction(self, "axis", "x", self.a, self.b).form,)

    def define_potential(self, x):
        return -self.strength / (1 + x[0] ** 2)


block = fm.Body("block", mass=1.0, position={"x": 0.5})
sol = fm.simulate(fm.Scene("magnet", [block, Magnet("magnet", a=block, strength=1.0)]), t_end=5.0)
print(sol["block.x"].min(), sol["block.x"].max())
""",
    "Contact": _BELT + "sol = fm.simulate(scene, t_end=40.0)\nprint(sol.force('sole')[0, -1], sol.mode('sole')[-1])\n"
               'figure = sol.plot.force("sole")\n',
    "normal.NormalLaw": """
pad = fm.Body("pad", mass=1.0, axes="xy", velocity={"y": 0.5})
belt = fm.Driven("belt", velocity={"x": 1.0})
press = fm.normal.Spring(axis="y", stiffness=10.0, damping=0.1, preload=2.0)
lining = fm.Contact("lining", pad, belt, law=fm.laws.Coulomb(mu_s=0.3), normal_force=press)
hold = fm.Spring("hold", pad, axis="x", stiffness=1.0)
sol = fm.simulate(fm.Scene("pressed", [pad, belt, hold, lining]), t_end=10.0)
print(sol.normal_force("lining").min(), sol.normal_force("lining").max())
""",
    "normal.Hertz": """
ball = fm.Body("ball", mass=1.0, axes="xy", velocity={"x": 1.0})
press = fm.normal.Hertz(axis="y", stiffness=1e4, preload=10.0)
floor = fm.Contact("floor", ball, law=fm.laws.Coulomb(mu_s=0.3), normal_force=press)
sol = fm.simulate(fm.Scene("ball", [ball, floor]), t_end=0.5)
print(sol.events[0])  # at rest after 1/(0.3 10)
""",
    "normal.Prescribed": """
block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
floor = fm.Contact("floor", block, law=fm.laws.Coulomb(mu_s=1.0), normal_force=fm.t)
sol = fm.simulate(fm.Scene("pressed harder", [block, floor]), t_end=2.0)
print(sol.events[0])  # at rest after sqrt(2)
""",
    "RigidBody": _swing('fm.Revolute("pin", arm.point("pin"))'),
    "Revolute": _swing('fm.Revolute("pin", arm.point("pin"), radius=0.05, friction=fm.laws.Coulomb(mu_s=0.4))', 8.0),
    "DryFriction": _DISC + 'pin = fm.Revolute("pin", disc)\n' + _mechanism(
        'disc, pin, fm.DryFriction("seal", disc, axis=pin, static=0.4, kinetic=0.3)', 'sol.events', before="")
        + 'figure = scene.draw()\n',
    "Stop": """
block = fm.Body("block", mass=1.0, velocity={"x": 2.0})
floor = fm.Contact("floor", block, law=fm.laws.Coulomb(mu_s=0.1), normal_force=9.81)
ends = fm.Stop("ends", block, axis="x", lower=-0.3, upper=0.3, stiffness=1e4, hunt_crossley=0.2)
scene = fm.Scene("a block between stops", [block, floor, ends])
sol = fm.simulate(scene, t_end=3.0)
print(sol.touches("ends").begin.round(4), sol.touches("ends").side)
figure = scene.draw()
""",
    "ImpactLaw": """
lower = fm.Body("lower", mass=1.0, axes="y", position={"y": 1.0}, velocity={"y": -1.0})
upper = fm.Body("upper", mass=2.0, axes="y", position={"y": 2.0}, velocity={"y": -1.0})
floor = fm.Stop("floor", lower, axis="y", lower=0.0, restitution=0.5)
touch = fm.Stop("touch", upper, lower, axis="y", lower=1.0, restitution=1.0)
for law in ("newton", "poisson"):
    scene = fm.Scene("two balls", [lower, upper, floor, touch, fm.ImpactLaw("impacts", law=law)])
    sol = fm.simulate(scene, t_end=1.5)
    print(law, sol.impulse("floor").normal, sol.impulse("touch").normal)
""",
    "Backlash": """
import sympy

motor, load = fm.Body("motor", mass=0.01), fm.Body("load", mass=0.05)
mesh = fm.Backlash("mesh", motor, load, axis="x", gap=0.1, stiffness=2000.0, hunt_crossley=0.5)
torque = fm.Force("torque", motor, axis="x", value=sympy.sin(2 * sympy.pi * fm.t))
dry = fm.DryFriction("dry", load, axis="x", static=0.3)
sol = fm.simulate(fm.Scene("a drive with play", [motor, load, mesh, torque, dry]), t_end=1.0)
print(len(sol.touches("mesh")), [event.kind for event in sol.events])
figure = sol.plot.velocities()
""",
    "TorsionSpring": _DISC + 'pin = fm.Revolute("pin", disc)\n' + _mechanism(
        'disc, pin, fm.TorsionSpring("spring", disc, stiffness=2.0),\n    fm.TorsionDamper("loss", disc, damping=0.01)',
        'sol["disc.angle"]', before="") + 'figure = scene.draw()\n',
    "Torque": _DISC + 'pin = fm.Revolute("pin", disc)\n' + _mechanism(
        'disc, pin, fm.Torque("motor", disc, value=0.1)', 'sol.velocity("disc.angle")', before=""),
    "Prismatic": """
slider = fm.RigidBody("slider", mass=1.0, inertia=0.1, velocity=(1.0, 0.0))
guide = fm.Prismatic("guide", slider, friction=fm.laws.Coulomb(mu_s=0.2))
weight = fm.Gravity("weight", acceleration={"y": -9.81})
scene = fm.Scene("slider", [slider, guide, weight])
sol = fm.simulate(scene, t_end=1.0)
print(sol.events[0])  # at rest after 1/(0.2 9.81)
figure = scene.draw()
""",
    "Fixed": """
plate = fm.RigidBody("plate", mass=1.0, inertia=0.1)
bracket = fm.RigidBody("bracket", mass=0.5, inertia=0.05, position=(1.0, 0.0))
weld = fm.Fixed("weld", plate, bracket)
pin = fm.Revolute("pin", plate)
weight = fm.Gravity("weight", acceleration={"y": -9.81})
scene = fm.Scene("welded", [plate, bracket, weld, pin, weight])
sol = fm.simulate(scene, t_end=1.0)
print(sol["plate.angle"][-1] - sol["bracket.angle"][-1])
figure = scene.draw()
""",
    "Rod": _swing('fm.Rod("rod", arm.point("pin"), fm.ground_point(0.0, 0.3), length=0.3)'),
    "RollerOnLine": _swing('fm.RollerOnLine("roller", arm.point("pin"), friction=fm.laws.Coulomb(mu_s=0.1)),\n'
                           '    fm.RollerOnLine("other", arm.point("tip"))', 1.0,
                           _PENDULUM.replace("inertia=0.1", "inertia=0.1, velocity=(1.0, 0.0)")).replace(
                               '"arm.angle"', '"arm.x"'),
    "RollerOnCircle": _swing('fm.RollerOnCircle("roller", arm.point("pin"), fm.ground_point(0.0, 1.0), radius=1.0)'),
    "Gear": """
small = fm.RigidBody("small", mass=1.0, inertia=0.01, angular_velocity=10.0)
large = fm.RigidBody("large", mass=4.0, inertia=0.16, position=(3.0, 0.0), angular_velocity=-5.0)
mesh = fm.Gear("mesh", small, large, ratio=2.0)  # teeth outside: they turn against each other
pins = [fm.Revolute("pin1", small), fm.Revolute("pin2", large, fm.ground_point(3.0, 0.0))]
scene = fm.Scene("gears", [small, large, mesh, *pins])
sol = fm.simulate(scene, t_end=1.0)
print(sol.velocity("small.angle")[-1], sol.velocity("large.angle")[-1])
figure = scene.draw()
""",
    "Wheel": """
disc = fm.RigidBody("disc", mass=2.0, inertia=0.01, position=(0.0, 0.1), velocity=(3.0, 0.0))
floor = fm.Wheel("floor", disc, radius=0.1, friction=fm.laws.Coulomb(mu_s=0.2))
weight = fm.Gravity("weight", acceleration={"y": -9.81})
scene = fm.Scene("a disc that is thrown", [disc, floor, weight])
sol = fm.simulate(scene, t_end=1.0)
print(sol.events[0], sol.velocity("disc.x")[-1])  # it rolls from v/(3 mu g) on, at 2/3 of its speed
figure = scene.draw()
""",
    "Rope": """
import math

ship, hand = fm.Body("ship", mass=10.0), fm.Body("hand", mass=1.0)
rope = fm.Rope("rope", (ship, hand), axes=("x", "x"), angle=math.pi, friction=0.5)
pull = fm.Force("pull", hand, axis="x", value=10.0)
wind = fm.Force("wind", ship, axis="x", value=10.0 + 10.0 * fm.t)
sol = fm.simulate(fm.Scene("mooring", [ship, hand, rope, pull, wind]), t_end=5.0)
mean, difference = sol.reaction("rope")[0], sol.force("rope")[0]
print(sol.events)
print((mean - difference / 2)[-1], (mean + difference / 2)[-1])  # at the hand, at the ship
figure = sol.plot.force("rope")
""",
    "DrivenAngle": _DISC.replace("20.0", "5.0") + _mechanism(
        'disc, fm.Revolute("pin", disc), fm.DrivenAngle("motor", disc, speed=5.0)', 'sol["disc.angle"]', before="")
        + 'figure = scene.draw()\n',
    "DrivenSlide": """
slider = fm.RigidBody("slider", mass=1.0, inertia=0.1, velocity=(0.5, 0.0))
guide = fm.Prismatic("guide", slider)
piston = fm.DrivenSlide("piston", slider, speed=0.5)
scene = fm.Scene("piston", [slider, guide, piston])
sol = fm.simulate(scene, t_end=2.0)
print(sol["slider.x"][-1])
figure = scene.draw()
""",
    "Signal": """
import numpy as np

t = np.linspace(0.0, 2.0, 401)  # stands for a measurement
rng = np.random.default_rng(0)
push = fm.Signal(t, 1.4 * np.sin(4.0 * t) + 0.05 * rng.standard_normal(t.size), name="push")
block = fm.Body("block", mass=1.0)
floor = fm.Contact("floor", block, law=fm.laws.Coulomb(mu_s=1.0, mu_k=0.8), normal_force=1.0)
load = fm.Force("load", block, axis="x", value=push.lowpass(20.0))
sol = fm.simulate(fm.Scene("pushed", [block, floor, load]), t_end=2.0)
print(push)
print(sol.events[0])
""",
    "parameter": """
load = fm.parameter("load", 1.0)  # one number in several places
blocks = [fm.Body(name, mass=1.0, velocity={"x": 1.0}) for name in ("a", "b")]
soles = [fm.Contact(f"sole of {b.name}", b, law=fm.laws.Coulomb(mu_s=0.5), normal_force=load) for b in blocks]
scene = fm.Scene("two blocks", [*blocks, *soles]).with_parameters({"load": 2.0})
sol = fm.simulate(scene, t_end=2.0)
print([event.t for event in sol.events])
""",
    "Units": 'scene = fm.models.belt_oscillator().with_units(fm.Units("s", "m", "N"))\n'
             "sol = fm.simulate(scene, t_end=20.0)\n"
             "figure = sol.plot.velocities()\nprint(scene.units)\n",
    "FrictionLaw": """
from dataclasses import dataclass

import sympy


@dataclass(frozen=True, kw_only=True)
class LogWeakening(fm.FrictionLaw):
    mu_s: float
    slope: float

    def define_coefficient(self, r):
        return self.mu_s / (1 + self.slope * sympy.log(1 + r))


law = LogWeakening(mu_s=1.0, slope=0.2)
print(law.coefficient([0.0, 1.0]), law.derivative([0.0, 1.0]))
figure = fm.plot.law_figure(law)
""",
    "laws.published": 'laws, told = fm.laws.published("fricmb.laws")\nprint(sorted(laws), told)\n',
    "laws.Creep": "law = fm.laws.TanhRegularised.example()\nprint(law.creep(0.5))\n",
    "laws.norm": "import sympy\n\nvx, vy = sympy.symbols('vx vy')\nprint(fm.laws.norm((vx, vy)))\n",
    "analysis.compare_regimes": """
scene = fm.models.belt_oscillator(law=fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.05))
regimes = fm.analysis.compare_regimes(scene, "sole", v_reg=1e-3, stiffness=1e3, t_end=30.0)
for regime in regimes:
    print(regime)
figure = regimes[1].solution.plot.velocities()
""",
    "analysis.path": """
import matplotlib.pyplot as plt
import numpy as np

law = fm.laws.Dahl(sigma0=1e4, mu=0.3)
pulled = fm.analysis.path(law, lambda t: np.full_like(t, 1e-3), np.linspace(0.0, 0.2, 401))
loop = fm.analysis.cycle(law, amplitude=1e-4, period=1.0)
print(pulled.force[-1], loop.work)
figure, ax = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
ax.plot(pulled.displacement, pulled.force, loop.displacement, loop.force)
ax.set(xlabel="displacement", ylabel="friction force")
""",
    "analysis.pull": """
law = fm.laws.LuGre.example()
print(fm.analysis.pull(law).force[-1], fm.analysis.settling_distance(law))
""",
    "testing.check_law": "fm.testing.check_law(fm.laws.Coulomb(mu_s=0.5, mu_k=0.4))  # or an error\nprint('kept')\n",
    "testing.check_element": 'block = fm.Body("block", mass=1.0)\n'
        'fm.testing.check_element(fm.Spring("spring", block, axis="x", stiffness=2.0), parts=[block])\nprint("kept")\n',
    "testing.check_model": "fm.testing.check_model(fm.models.belt_oscillator)\nprint('kept')\n",
    "integrate.Integrator": """
print(sorted(fm.integrators))
print(fm.integrators["radau"](stages=7))
""",
    "integrate.OneStepMethod": """
from dataclasses import dataclass

from fricmb.integrate import OneStepMethod


@dataclass(frozen=True, kw_only=True)
class Even(OneStepMethod):
    name = "even"
    order = "s"

    def nodes(self, problem, rtol):
        return (0.2, 0.4, 0.6, 0.8, 1.0)


for method in ("radau", Even()):
    sol = fm.simulate(fm.models.belt_oscillator(), t_end=50.0, rtol=1e-6, method=method)
    print(f"{sol.stats.method:6} {sol.stats.n_steps:4} steps, last transition {sol.events[-1].t:.9f}")
""",
    "testing.check_integrator": "fm.testing.check_integrator(fm.integrators['radau'](stages=5))\nprint('kept')\n",
    "simulate": _RUN + "print(sol.summary())\nfigure = sol.plot.velocities()\n",
    "sweep": 'scene = fm.models.belt_oscillator()\n'
             'runs = [{"belt.velocity.x": v} for v in (0.1, 0.2, 0.4)]\n'
             "count = lambda sol: len(sol.events)\n"
             "print(fm.sweep(scene, runs, t_end=50.0, workers=1, progress=False, reduce=count))\n",
    "SweepResults": """
import numpy as np

scene = fm.models.belt_oscillator()
runs = [{"belt.velocity.x": v} for v in np.linspace(0.05, 0.6, 12)]
times = np.linspace(0.0, 100.0, 4001)
reach = lambda sol: sol["mass.x"].max()
found = fm.sweep(scene, runs, t_end=100.0, t_eval=times, workers=1, progress=False, reduce=reach)
print(found.to_pandas().head(3))
figure = found.plot(label="reach of the mass")
""",
    "Solution": _RUN + 'print(sol["mass.x"][-1], sol.at([1.0, 2.0])["mass.x"])\n'
                "print(sol.events[0], sol.energy.residual[-1])\n",
    "solve_dae": """
import numpy as np


def circle(t, y, yp):
    x, v = y
    return np.array([yp[0] - v, x**2 + v**2 - 1.0])


result = fm.solve_dae(circle, (0.0, 1.0), [0.0, 1.0], rtol=1e-8, atol=1e-10)
print(result.y[0, -1])  # sin(1)
""",
    "audit.Audit": _RUN + "print(sol.audit())\n",
    "plot.SolutionPlots": _BRAKE + 'figure = sol.plot.transitions()\n',
    "plot.law_figure": 'figure = fm.plot.law_figure(fm.laws.Stribeck.example())\n',
    "plot.law": 'figure = fm.plot.law(fm.laws.Dahl.example())\n',
    "plot.show": _BRAKE + "figure = sol.plot.velocities()\nfm.plot.show(figure)\n",
    "plot.use": 'fm.plot.use("light")\nwith fm.plot.theme("dark"):\n'
                "    figure = fm.plot.law_figure(fm.laws.Stribeck.example())\n",
    "plot.eigenvalues": _MODES + "figure = fm.plot.eigenvalues(modes)\n",
    "analysis.uniform": _SPECTRUM + "print(signal.dt, len(signal.x), signal.folded)\n",
    "analysis.maximum_entropy_spectrum": _SPECTRUM + """
import matplotlib.pyplot as plt

figure, ax = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
for estimate in (fm.analysis.maximum_entropy_spectrum, fm.analysis.welch_spectrum):
    omega, power = estimate(signal.x, signal.dt)
    ax.semilogy(omega[omega < 20], power[omega < 20], label=estimate.__name__)
ax.set(xlabel="angular frequency", ylabel="power density")
ax.legend()
""",
    "analysis.spectrogram": _SPECTRUM + """
running = fm.analysis.spectrogram(signal.x, signal.dt, segment=400)
orders = fm.analysis.order_map(running, fm.analysis.sliding_speed(sol, "lining", running.t), [0.5, 1.0, 2.0])
print(running.power.shape, orders.power.shape)
""",
    "analysis.spectral_peaks": _SPECTRUM
        + "print(fm.analysis.spectral_peaks(signal.x, signal.dt, between=(3.0, 9.0)))\n",
    "analysis.AliasingWarning": """
import warnings

sol = fm.simulate(fm.models.brake4dof("2"), t_end=100.0)
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    fm.analysis.uniform(sol, "pad.y.velocity", dt=1.0)
print(said[0].category.__name__)
""",
    "analysis.steady_sliding": _FALLING + "print(fm.analysis.steady_sliding(scene))\n",
    "analysis.complex_eigenvalues": _MODES + "print(modes)\nfigure = fm.plot.eigenvalues(modes)\n",
    "analysis.stability_map": _FALLING + """
found = fm.analysis.stability_map(
    scene, over=("belt.velocity.x", "spring.stiffness"), values=([0.05, 0.1, 0.2, 0.4], [0.5, 1.0, 2.0]),
)
print(found.unstable)
figure = fm.plot.stability(found)
""",
    "squeal.study": """
study = fm.squeal.study(fm.models.minimal_flutter(), over={"sole.law.mu_s": [0.4, 0.6, 0.8, 1.0]}, progress=False)
print(study)
print(study.feed())
print(study.derivatives(study.thresholds[0]))
print(study.growth())
print(study.saturation())
print(study.uncertainty({"sole.law.mu_s": 0.1}, {"sole.law.mu_s": 0.7}))
figure = study.plot()
""",
    "analysis.energy_ledger": _RUN + "ledger = fm.analysis.energy_ledger(sol)\nprint(ledger.phases(\"sole\")[:2])\n"
        "figure = sol.plot.energy()\n",
    "analysis.limit_cycle": _CYCLE + """
print(cycle)
print(cycle.multipliers, cycle.amplitude("mass.x"))
print(cycle.sensitivity("period", "belt.velocity.x"), cycle.sensitivity("mass.x", "belt.velocity.x"))
""",
    "analysis.continue_cycle": _CYCLE + """
branch = fm.analysis.continue_cycle(cycle, "belt.velocity.x", to=3.0, progress=False)
print(branch)
print(branch.special[0].residual)
figure = branch.plot.diagram("mass.x")
""",
    "analysis.Flip": """
import sympy

mass = fm.Body("mass", mass=1.0)
belt = fm.Driven("belt", velocity={"x": 0.2})
law = fm.laws.HyperbolicStribeck(mu_s=1.0, mu_k=0.0, delta=3.0)
omega = fm.parameter("omega", 0.73)
parts = [
    mass, belt, fm.Spring("spring", mass, axis="x", stiffness=1.0), fm.Damper("damper", mass, axis="x", damping=0.05),
    fm.Contact("sole", mass, belt, law=law, normal_force=1.0),
    fm.Force("drive", mass, axis="x", value=sympy.cos(omega * fm.t)),
]
cycle = fm.analysis.limit_cycle(fm.Scene("forced", parts))
branch = fm.analysis.continue_cycle(cycle, "omega", to=0.715, progress=False)
print(branch.special[0])
doubled = branch.switch(branch.special[0], points=4, progress=False)
print(doubled.cycles[-1])
""",
    "analysis.lyapunov": """
scene = fm.models.belt_oscillator()
print(fm.analysis.lyapunov(scene, t_end=100.0, intervals=50, progress=False))  # each landing cuts a direction off
""",
    "analysis.poincare_section": _RUN + """
found = fm.analysis.poincare_section(sol, ("mass.x.velocity", 0.0), discard=0.3)
print(found.t, found["mass.x"])
""",
    "analysis.NaturalModes": """
a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=2.0)
scene = fm.Scene("two", [
    a, b, fm.Spring("k1", a, axis="x", stiffness=3.0), fm.Spring("k2", a, b, axis="x", stiffness=1.0),
    fm.Damper("c", b, axis="x", damping=0.1),
])
print(scene.modes())
""",
    "analysis.frequency_response": """
import sympy

omega, mass = fm.parameter("omega", 1.0), fm.Body("mass", mass=1.0)
load = fm.Force("load", mass, axis="x", value=0.5 * sympy.cos(omega * fm.t))
spring, damper = fm.Spring("spring", mass, axis="x", stiffness=1.0), fm.Damper("damper", mass, axis="x", damping=0.1)
sole = fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=0.2), normal_force=1.0)
scene = fm.Scene("driven", [mass, spring, damper, load, sole])
found = fm.analysis.frequency_response(
    scene, over="omega", values=[0.4, 0.6, 0.8, 1.0, 1.2, 1.5], measure="mass.x", progress=False
)
print(found)
figure = found.plot.amplitude()
""",
    "analysis.bifurcation_diagram": """
import numpy as np

scene = fm.models.belt_oscillator()
found = fm.analysis.bifurcation_diagram(
    scene, "belt.velocity.x", np.linspace(0.05, 0.5, 10), t_end=300.0, signal="mass.x",
    section=("mass.x.velocity", 0.0), workers=1, progress=False,
)
print(found.count())
figure = found.plot.diagram()
""",
    "fit": """
import numpy as np

t = np.linspace(0.5, 60.0, 160)
scene = fm.models.belt_oscillator(belt=0.4, mu_s=1.4, mu_k=0.9, damping=0.15)
x = fm.simulate(scene, t_end=60.0, t_eval=t, rtol=1e-9)["mass.x"]
measured = x + 0.02 * np.random.default_rng(1).standard_normal(160)

guess = fm.models.belt_oscillator(belt=0.4, damping=0.1)
bounds = {"sole.law.mu_s": (1.0, 2.0), "sole.law.mu_k": (0.5, 1.2), "damper.damping": (0.0, 0.5)}
found = fm.fit(guess, {"t": t, "mass.x": measured}, parameters=bounds, progress=False)
print(found)
figure = found.plot.residuals()
""",
    "analysis.modal_energy": _BRAKE + "print(fm.analysis.modal_energy(sol).omega)\n",
} | _examples_space.EXAMPLES | _examples_fe.EXAMPLES
SHARED = {
    "analysis.Cycle": "analysis.limit_cycle", "analysis.Branch": "analysis.continue_cycle",
    "analysis.Special": "analysis.continue_cycle", "analysis.Fold": "analysis.continue_cycle",
    "analysis.StickDisappears": "analysis.continue_cycle", "analysis.StickAppears": "analysis.continue_cycle",
    "analysis.Grazing": "analysis.continue_cycle", "analysis.NeimarkSacker": "analysis.Flip",
    "analysis.Lyapunov": "analysis.lyapunov", "analysis.Poincare": "analysis.poincare_section",
    "analysis.BifurcationDiagram": "analysis.bifurcation_diagram", "Fit": "fit", "plot.FitPlots": "fit",
    "analysis.FrequencyResponse": "analysis.frequency_response", "plot.ResponsePlots": "analysis.frequency_response",
    "plot.BranchPlots": "analysis.continue_cycle", "plot.DiagramPlots": "analysis.bifurcation_diagram",
    "Parameter": "parameter", "coordinate": "Force", "speed": "Force", "PointDamper": "PointSpring",
    "normal.Spring": "normal.NormalLaw", "normal.Constant": "Contact", "ground_point": "Rod", "Gravity": "RigidBody",
    "TorsionDamper": "TorsionSpring", "Joint": "Revolute", "audit.Check": "audit.Audit",
    "plot.stability": "analysis.stability_map", "plot.theme": "plot.use", "analysis.Regime": "analysis.compare_regimes",
    "analysis.cycle": "analysis.path", "analysis.Path": "analysis.path", "analysis.settling_distance": "analysis.pull",
    "analysis.welch_spectrum": "analysis.maximum_entropy_spectrum", "analysis.Samples": "analysis.uniform",
    "analysis.order_map": "analysis.spectrogram", "analysis.sliding_speed": "analysis.spectrogram",
    "analysis.Spectrogram": "analysis.spectrogram", "analysis.OrderMap": "analysis.spectrogram",
    "analysis.Peaks": "analysis.spectral_peaks", "analysis.SteadySliding": "analysis.steady_sliding",
    "analysis.Eigenvalues": "analysis.complex_eigenvalues", "analysis.Crossing": "analysis.complex_eigenvalues",
    "analysis.StabilityMap": "analysis.stability_map", "analysis.EnergyLedger": "analysis.energy_ledger",
    "analysis.Phase": "analysis.energy_ledger", "analysis.ModalEnergy": "analysis.modal_energy",
} | dict.fromkeys(
    [
        f"squeal.{kind}"
        for kind in (
            "Study", "Threshold", "Feed", "Derivatives", "Growth", "Saturation", "Screening", "Uncertainty",
        )
    ],
    "squeal.study",
) | _examples_fe.SHARED | _examples_space.SHARED  # fmt: skip


def example(name: str) -> str | None:
    """Code of the example of a public name, as it is called in ``fm``; None where there is none."""
    kind, _, rest = name.partition(".")
    if kind == "laws" and rest in fm.laws.names:
        body = f"law = fm.laws.{rest}.example()\nprint(law)\nfigure = fm.plot.law_figure(law)\n"
    elif kind == "models" and rest in catalogue:
        body = f"scene = fm.models.{rest}()\nsol = fm.simulate(scene, t_end={catalogue[rest].t_end:g})\n"
        body += "print(len(sol.events), sol.stats.n_steps)\n"
    else:
        found = EXAMPLES.get(SHARED.get(name, name))
        if found is None:
            return None
        body = found.lstrip("\n")
    return _with_imports(body)


def _with_imports(body: str) -> str:
    """Imports on top, as ruff sorts them: the standard library, others, fricmb."""
    lines = body.splitlines()
    first = [line for line in lines if line.startswith(("import ", "from "))]
    standard = [line for line in first if line.split()[1] in ("dataclasses", "warnings")]
    own = [line for line in first if line.startswith("from fricmb")]
    others = [line for line in first if line not in (*standard, *own)]
    groups = ["\n".join(group) for group in (standard, others, ["import fricmb as fm", *own]) if group]
    rest = "\n".join(line for line in lines if line not in first).strip("\n")
    return "\n\n".join(groups) + ("\n\n\n" if rest.startswith(("@", "def ", "class ")) else "\n\n") + rest + "\n"
