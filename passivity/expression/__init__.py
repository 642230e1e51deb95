"""Impedance expressions: from text to a tree."""
