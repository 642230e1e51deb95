"""Exact verdicts for networks with several ports: matrices of rational functions and state spaces."""
