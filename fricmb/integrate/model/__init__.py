"""A problem as arrays for kernels, and its forces, laws and accelerations at one instant."""
