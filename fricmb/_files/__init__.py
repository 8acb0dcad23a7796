"""Files that others wrote: which reader one goes to, text and containers, and errors of one sentence."""

from fricmb._files._containers import hdf5_arrays, mat_arrays, npz_arrays
from fricmb._files._formats import Formats, one_sentence
from fricmb._files._heads import Clipped, wav_fits
from fricmb._files._matrix_market import matrix_market
from fricmb._files._output2 import Block, Output2
from fricmb._files._output4 import op4_fits
from fricmb._files._text import text_of

__all__ = [
    "Block", "Clipped", "Formats", "Output2", "hdf5_arrays", "mat_arrays", "matrix_market", "npz_arrays",
    "one_sentence", "op4_fits", "text_of", "wav_fits",
]  # fmt: skip
