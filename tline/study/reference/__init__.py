"""Exact solutions of scenes, slow and trustworthy: nothing in here uses the solver."""

from tline.study.reference.exact import Exact, Solution, exact
from tline.study.reference.rays import lattice

__all__ = ["Exact", "Solution", "exact", "lattice"]
