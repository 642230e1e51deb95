"""Stores: elements whose flow depends on a state."""
