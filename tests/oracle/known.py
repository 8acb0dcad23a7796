"""Runs that are known to be wrong, with the cause: a test holds this list exact, an entry that passes is removed.

``CELLS``: law, situation and method of the quick cells of the table.  ``PARTS``: element or joint, and method.
"""

from __future__ import annotations

CELLS: dict[tuple[str, str, str], str] = {}

#: Element or joint and method.
PARTS: dict[tuple[str, str], str] = {}
