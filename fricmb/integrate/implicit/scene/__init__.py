"""What kernels are given of a problem, the state of a run, and what is watched along it."""
