"""Hostile input by the million: whatever is given, the command answers in time, in bounds, and touches nothing else."""
