"""Inputs as integrators see them: how long a step may be before it could pass over what a prescribed function does."""
