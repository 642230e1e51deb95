"""The kernel of many runs: copies of one network with different numbers, and the extremes of their waves.

Copies are the last axis of all arrays, so that loops over them vectorise; those over the few points of a slab would
not. Slabs of a period differ, periods are alike.
"""
