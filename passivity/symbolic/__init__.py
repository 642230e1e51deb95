"""Impedances and reflections with parameters that have no value, only assumptions."""
