"""Formulas as arrays, polynomials of a step, and lengths of steps: what several methods share."""
