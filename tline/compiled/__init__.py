"""Compiled units: how the arithmetic of all packages is compiled, kept on disk, and found again without numba.

A *unit* is a C function of numbers and of packed structures that allocates nothing. `structure` packs named tuples of
numbers and arrays into words and hands their address over; `by_reference` is how numba sees them; `compiler`
translates a unit with all that it calls; `object_code` keeps what it made and loads it by llvmlite alone; `stamp` says
which source it was made of; `trusted_file` reads nothing that somebody else may have written; `announce` says on a
terminal what one waits for.
"""
