"""Exact rational functions of the Laplace variable."""
