"""Many runs of one scene at once, with numbers that vary from copy to copy: the basis of sweeps of simple scenes."""

from tline.solver.many.batches import ProbeOfCopies
from tline.solver.many.runs import ManyRuns, many_runs

__all__ = ["ManyRuns", "ProbeOfCopies", "many_runs"]
