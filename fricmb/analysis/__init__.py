"""What a run or a scene says: spectra of the motion, stability of steady sliding, laws under a prescribed motion."""

from fricmb.analysis._crossings import Crossing
from fricmb.analysis._eigenvalues import Eigenvalues, StabilityMap, complex_eigenvalues, stability_map
from fricmb.analysis._errors import AliasingWarning, AnalysisError
from fricmb.analysis._losses import EnergyLedger, Phase, energy_ledger
from fricmb.analysis._modes import ModalEnergy, modal_energy
from fricmb.analysis._natural import NaturalModes
from fricmb.analysis._orders import OrderMap, order_map, sliding_speed
from fricmb.analysis._paths import Path, compiled_force, cycle, path, pull, settling_distance
from fricmb.analysis._peaks import Peaks, spectral_peaks
from fricmb.analysis._poincare import BifurcationDiagram, Poincare, bifurcation_diagram, poincare_section
from fricmb.analysis._regimes import Regime, compare_regimes
from fricmb.analysis._response import FrequencyResponse, frequency_response
from fricmb.analysis._sampling import Samples, uniform
from fricmb.analysis._spectrum import maximum_entropy_spectrum
from fricmb.analysis._steady import SteadySliding, steady_sliding
from fricmb.analysis._welch import Spectrogram, spectrogram, welch_spectrum
from fricmb.analysis.cycles import (
    Branch,
    Cycle,
    Flip,
    Fold,
    Grazing,
    Lyapunov,
    NeimarkSacker,
    Special,
    StickAppears,
    StickDisappears,
    continue_cycle,
    limit_cycle,
    lyapunov,
)

__all__ = [
    "AliasingWarning",
    "AnalysisError",
    "BifurcationDiagram",
    "Branch",
    "Crossing",
    "Cycle",
    "Eigenvalues",
    "EnergyLedger",
    "Flip",
    "Fold",
    "FrequencyResponse",
    "Grazing",
    "Lyapunov",
    "ModalEnergy",
    "NaturalModes",
    "NeimarkSacker",
    "OrderMap",
    "Path",
    "Peaks",
    "Phase",
    "Poincare",
    "Regime",
    "Samples",
    "Special",
    "Spectrogram",
    "StabilityMap",
    "SteadySliding",
    "StickAppears",
    "StickDisappears",
    "bifurcation_diagram",
    "compare_regimes",
    "compiled_force",
    "complex_eigenvalues",
    "continue_cycle",
    "cycle",
    "energy_ledger",
    "frequency_response",
    "limit_cycle",
    "lyapunov",
    "maximum_entropy_spectrum",
    "modal_energy",
    "order_map",
    "path",
    "poincare_section",
    "pull",
    "settling_distance",
    "sliding_speed",
    "spectral_peaks",
    "spectrogram",
    "stability_map",
    "steady_sliding",
    "uniform",
    "welch_spectrum",
]
