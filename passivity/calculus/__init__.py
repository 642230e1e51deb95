"""Verdicts as a calculus: one graph of shared nodes, one kind of fact, one table of rules."""
