"""Friction models and their testbench (to come)."""
