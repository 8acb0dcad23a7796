"""Pictures of the built-in models: how they are built, and a run."""

from pathlib import Path

import fricmb as fm

# The degrees of freedom whose velocity is drawn, where the first two are not those that tell most.
TELLING = {
    "brake4dof": ["pad.x", "rotor.x"],
    "block_stack": ["block1.x", "block2.x", "block3.x"],
    "pad_rotor": ["pad.p1.x", "rotor.p1.x"],
    "rotor_doublet": ["disc.mode1", "pad1.x"],
    "stick_slip_chain": ["block1.x", "block5.x"],
    "dry_pendulum": ["arm.angle"],
    "andrews": ["K1.angle", "K3.angle"],
    "car_axis": ["left.y", "right.y"],
    "sprag_slip": ["arm.angle"],
    "slider_crank": ["slider.x"],
    "painleve_rod": ["rod.angle"],
    "four_bar": ["crank.angle", "rocker.angle"],
    "band_brake": ["drum.angle", "holder.x"],
    "belt_drive": ["drive.angle", "driven.angle"],
    "wheel_on_slope": ["disc.x", "disc.angle"],
    "drive_train": ["wheel.angle", "disc.angle"],
    "bouncing_ball": ["ball.x", "ball.y"],
    "rocking_block": ["block.angle"],
    "gear_rattle": ["drive.angle", "gear.angle"],
    "newtons_cradle": ["ball1.x", "ball3.x", "ball5.x"],
    "woodpecker": ["bird.sleeve.y", "bird.beak.x"],
    "dropped_disc": ["disc.x", "disc.angle"],
    "heavy_top": ["top.axis_x", "top.axis_z"],
    "rising_top": ["top.axis_z", "top.spin"],
    "billiard": ["ball.x", "ball.y", "ball.turn_x"],
    "rolling_coin": ["coin.x", "coin.axis_z"],
    "turntable": ["ball.x", "ball.y"],
    "ball_in_cylinder": ["ball.x", "ball.z"],
    "dry_ball_joint": ["bob.x", "bob.y", "bob.z"],
    "wheelset": ["axle.y", "axle.x"],
    "wobbling_disc_brake": ["disc.axis_x", "disc.axis_y"],
}

# Where the standard run is too short for what the model is about: another end, and arguments.
STORIES = {"wobbling_disc_brake": (1.5, {"speed": 200.0, "mu": 0.8})}


def write(model, folder: Path) -> list[str]:
    """The names of two files: the scheme of a model, and its standard run."""
    scene = model.build()
    scheme = scene.draw()
    t_end, arguments = STORIES.get(model.name, (model.t_end, {}))
    sol = fm.simulate(model.build(**arguments), t_end=t_end, rtol=1e-6)
    run = sol.plot.velocities(TELLING.get(model.name, list(sol.dof_names[:2])))
    names = [f"_{model.name}_{what}.png" for what in ("scheme", "run")]
    for figure, name in zip((scheme, run), names, strict=True):
        figure.savefig(folder / name, dpi=110)
    return names
