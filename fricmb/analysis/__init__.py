"""What a run or a scene says: spectra of the motion, stability of steady sliding, laws under a prescribed motion."""

from fricmb.analysis._eigenvalues import Eigenvalues, StabilityMap, complex_eigenvalues, stability_map
from fricmb.analysis._errors import AliasingWarning, AnalysisError
from fricmb.analysis._ledger import EnergyLedger, Phase, energy_ledger
from fricmb.analysis._modes import ModalEnergy, modal_energy
from fricmb.analysis._orders import OrderMap, order_map, sliding_speed
from fricmb.analysis._paths import Path, compiled_force, cycle, path, pull, settling_distance
from fricmb.analysis._peaks import Peaks, spectral_peaks
from fricmb.analysis._regimes import Regime, compare_regimes
from fricmb.analysis._sampling import Samples, uniform
from fricmb.analysis._spectrum import maximum_entropy_spectrum
from fricmb.analysis._steady import SteadySliding, steady_sliding
from fricmb.analysis._track import Crossing
from fricmb.analysis._welch import Spectrogram, spectrogram, welch_spectrum

__all__ = [
    "AliasingWarning",
    "AnalysisError",
    "Crossing",
    "Eigenvalues",
    "EnergyLedger",
    "ModalEnergy",
    "OrderMap",
    "Path",
    "Peaks",
    "Phase",
    "Regime",
    "Samples",
    "Spectrogram",
    "StabilityMap",
    "SteadySliding",
    "compare_regimes",
    "compiled_force",
    "complex_eigenvalues",
    "cycle",
    "energy_ledger",
    "maximum_entropy_spectrum",
    "modal_energy",
    "order_map",
    "path",
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
