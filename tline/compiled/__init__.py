"""Compiled units: compilation of the arithmetic of all packages, its storage on disk, and loading without numba.

A *unit* is a C function of numbers and of packed structures that allocates nothing. `structure` packs named tuples of
numbers and arrays into words and hands their address over; `compiler` defines their types in numba, and translates a
unit with all functions that it calls, with accesses to arrays by `indexing`; `object_code` stores the result in files
that nobody else can have written, and loads it by llvmlite alone; `stamp` identifies its source; `announce` reports
compilation on a terminal.
"""
