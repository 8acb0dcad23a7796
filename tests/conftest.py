"""Settings of the whole suite."""

import sys
from pathlib import Path

from hypothesis import settings

# how long an example takes says something of the machine only
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

# so that tests of tests.oracle find it; last, so that fricmb is the one installed
sys.path.append(str(Path(__file__).parents[1]))
