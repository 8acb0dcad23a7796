"""Kinds of pictures of ``fricmb plot``."""

#: Kinds that need a signal, contact or element (``--of``), and those that write a file of their own.
NEED_NAME = ("phase", "path", "force", "hysteresis", "signals", "spectrum", "spectrogram", "orders", "sound")
OWN_FILE = {"animation": ".gif", "sound": ".wav", "view": ".html"}
KINDS = (
    "velocities", "positions", "signals", "phase", "path", "force", "hysteresis", "transitions", "energy", "spectrum",
    "spectrogram", "orders", *OWN_FILE,
)  # fmt: skip
#: Those that have frequencies, and those that take several names.
FREQUENCIES = ("spectrum", "spectrogram", "orders")
SEVERAL = ("velocities", "positions", "signals")
