"""How kernels are compiled, kept on disk, and call one another, templates and LAPACK."""
