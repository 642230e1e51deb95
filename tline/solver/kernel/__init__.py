"""Compiled units; they know arrays and nothing else."""
