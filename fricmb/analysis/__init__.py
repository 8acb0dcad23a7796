"""What a trajectory says: spectra of the motion."""

from fricmb.analysis._errors import AliasingWarning, AnalysisError
from fricmb.analysis._orders import OrderMap, order_map, sliding_speed
from fricmb.analysis._peaks import Peaks, spectral_peaks
from fricmb.analysis._sampling import Samples, uniform
from fricmb.analysis._spectrum import maximum_entropy_spectrum
from fricmb.analysis._welch import Spectrogram, spectrogram, welch_spectrum

__all__ = [
    "AliasingWarning",
    "AnalysisError",
    "OrderMap",
    "Peaks",
    "Samples",
    "Spectrogram",
    "maximum_entropy_spectrum",
    "order_map",
    "sliding_speed",
    "spectral_peaks",
    "spectrogram",
    "uniform",
    "welch_spectrum",
]
