"""Functions that end a step as they fall below 0, and where in it they do."""
