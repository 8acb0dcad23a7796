"""Settings of the whole suite."""

import signal
import sys
from pathlib import Path

from hypothesis import settings

# how long an example takes says something of the machine only
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

# what runs in the background may be told to ignore Ctrl-C: a test that sends it would wait for ever
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# so that tests of tests.oracle find it; last, so that fricmb is the one installed
sys.path.append(str(Path(__file__).parents[1]))
