"""Where forces and loads bend with the motion: the functions whose sign changes tell, as arrays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from fricmb.equations import Template
from fricmb.integrate.problem import Bends
from fricmb.system._tables import Argument, TableBuilder

#: A template of such functions, its parameters and arguments.
Bend = tuple[Template, Sequence[float], Sequence[Argument]]


def bends_of(found: Iterable[Bend], n: int, n_u: int) -> Bends:
    """The arrays for n coordinates and n_u signals."""
    table, counts = TableBuilder(), [0]
    for template, parameters, arguments in found:
        table.add(template.address, parameters, arguments)
        counts.append(template.facts["count"])
    return Bends(table=table.build(n, n_u), start=np.cumsum(counts, dtype=np.int64)) if len(table) else NO_BENDS


#: Of scenes without any.
NO_BENDS = Bends()
