"""The built-in integrators by name."""

from __future__ import annotations

from fricmb.integrate.collocation import Collocation
from fricmb.integrate.integrator import Integrator
from fricmb.integrate.methods.bdf import Bdf
from fricmb.integrate.methods.bdf2_paper import Bdf2Paper
from fricmb.integrate.methods.radau import Radau
from fricmb.integrate.taylor import Taylor

#: Built-in integrators by the name that ``simulate(method=...)`` takes.
integrators: dict[str, type[Integrator]] = {kind.name: kind for kind in (Bdf, Bdf2Paper, Collocation, Radau, Taylor)}
