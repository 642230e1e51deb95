"""Steady states that constant sources imply."""
