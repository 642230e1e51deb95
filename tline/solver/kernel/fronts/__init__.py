"""Slabs that hold fronts: pieces between breakpoints that travel."""
