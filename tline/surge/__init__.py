"""Surges in networks: what is operated, by words, and what comes of it."""
