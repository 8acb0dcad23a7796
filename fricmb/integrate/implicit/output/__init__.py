"""Rows of a run, the trajectory made of them, and why a run has stopped."""
