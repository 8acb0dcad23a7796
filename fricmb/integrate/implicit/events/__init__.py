"""Functions that end a mode as they fall below 0, and where in a step they do."""
