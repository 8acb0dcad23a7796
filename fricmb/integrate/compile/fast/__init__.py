"""Quicker passes over kernels, which rest on numba's insides; nothing else of the package does.

They compile in about half the time of numba's own passes, to the same results.  Where a version of numba has changed
what they rest on, kernels are compiled by numba's own: :mod:`fricmb.integrate.compile.plain` decides, and is the only
one that imports what is here.
"""
