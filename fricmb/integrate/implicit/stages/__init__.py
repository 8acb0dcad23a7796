"""One step of given modes: its stages solved by Newton in a band, or by a series."""
