"""The figures of the source of :func:`fricmb.models.brake4dof`, drawn again, with numbers for what it says about them.

B. Kinkaid, O. O'Reilly, P. Papadopoulos, On the transient dynamics of a multi-degree-of-freedom friction oscillator: a
new mechanism for disc brake noise, J. Sound and Vibration 287 (2005) 901-917.  Statements are in our own words.
"""

from fricmb.models.brake_paper._figures import FIGURES, PaperFigure
from fricmb.models.brake_paper._measures import Finding, Spikes, shift_of, slope, spikes
from fricmb.models.brake_paper._runs import T_END, run
from fricmb.models.brake_paper._valleys import Valleys, valleys

__all__ = [
    "FIGURES",
    "T_END",
    "Finding",
    "PaperFigure",
    "Spikes",
    "Valleys",
    "run",
    "shift_of",
    "slope",
    "spikes",
    "valleys",
]
