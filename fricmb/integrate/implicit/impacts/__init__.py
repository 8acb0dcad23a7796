"""Impacts of rigid parts: laws, order, rest, impulses."""
