"""Stick and slip at one instant: which contacts hold, and where transitions are."""
