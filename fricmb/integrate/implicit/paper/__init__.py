"""The published fixed-step scheme on the same equations."""
