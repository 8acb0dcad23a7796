"""Rows that a run leaves, and motion between them."""
