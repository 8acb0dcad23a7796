from ._branches import BranchPlots as BranchPlots
from ._branches import DiagramPlots as DiagramPlots
from ._figure import show as show
from ._fits import FitPlots as FitPlots
from ._law import law as law
from ._law import law_figure as law_figure
from ._response import ResponsePlots as ResponsePlots
from ._solution import SolutionPlots as SolutionPlots
from ._stability import eigenvalues as eigenvalues
from ._stability import stability as stability
from ._style import BLUE as BLUE
from ._style import COLOURS as COLOURS
from ._style import DARK as DARK
from ._style import ORANGE as ORANGE
from ._style import THIN as THIN
from ._style import finish as finish
from ._style import theme as theme
from ._style import use as use
from ._units import Units as Units

__all__ = [
    "BLUE",
    "COLOURS",
    "DARK",
    "ORANGE",
    "THIN",
    "BranchPlots",
    "DiagramPlots",
    "FitPlots",
    "ResponsePlots",
    "SolutionPlots",
    "Units",
    "eigenvalues",
    "finish",
    "law",
    "law_figure",
    "show",
    "stability",
    "theme",
    "use",
]
