"""Losses all along lines: diamonds in which slabs of both waves meet, and halves of them at the ends."""
