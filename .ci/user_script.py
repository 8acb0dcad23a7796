"""What a user may write, under the strictest settings of two type checkers: run and checked, installed, by .ci/run."""

from dataclasses import dataclass

import numpy as np
import sympy  # type: ignore[import-untyped]  # has no types

import fricmb as fm


@dataclass(frozen=True, kw_only=True)
class LogWeakening(fm.FrictionLaw):
    """A law of one's own."""

    mu_s: float
    slope: float

    def define_coefficient(self, r: sympy.Expr) -> sympy.Expr:
        """Friction that falls with the logarithm of speed."""
        return self.mu_s / (1 + self.slope * sympy.log(1 + r))


def scene_with(law: fm.FrictionLaw) -> fm.Scene:
    """A block on a belt."""
    block = fm.Body("block", mass=1.0)
    belt = fm.Driven("belt", velocity={"x": 0.1})
    spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
    return fm.Scene("stick-slip", [block, belt, spring, fm.Contact("sole", block, belt, law=law, normal_force=1.0)])


def reach(sol: fm.Solution) -> float:
    """What a sweep asks of each run."""
    return float(np.abs(sol["block.x"]).max())


def main() -> None:
    """Run, read, sweep."""
    scene = scene_with(LogWeakening(mu_s=1.5, slope=0.4))
    sol = fm.simulate(scene, t_end=20.0, rtol=1e-8, t_eval=np.linspace(0.0, 20.0, 201))
    first = sol.events[0]
    print(f"{first.t:.6f} {first.contact} {first.kind} {sol.force('sole').shape} {sol.energy.residual.max():.0e}")
    runs = [{"spring.stiffness": k} for k in (1.0, 2.0)]
    for found in fm.sweep(scene, runs, t_end=5.0, reduce=reach, workers=1, progress=False):
        print(f"{found:.6f}")
    try:
        fm.Body("heavy", mass=-1.0)
    except fm.SceneError as error:
        print(error)


if __name__ == "__main__":
    main()
