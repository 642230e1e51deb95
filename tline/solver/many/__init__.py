"""Many runs of one scene at once, with numbers that vary from copy to copy: what sweeps of simple scenes stand on."""

from tline.solver.many.batches import ProbeOfCopies
from tline.solver.many.runs import ManyRuns, many_runs

__all__ = ["ManyRuns", "ProbeOfCopies", "many_runs"]
