"""One contact under constant friction and linear loads: kernels of its own."""
