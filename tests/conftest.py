"""Settings of the whole suite."""

from hypothesis import settings

# how long an example takes says something of the machine only
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
