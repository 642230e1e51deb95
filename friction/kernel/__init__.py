"""Compiled code of the package: it knows arrays and numbers and nothing else."""
