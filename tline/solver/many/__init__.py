"""Many runs of one scene in one call, with numbers that vary from copy to copy."""

from tline.solver.many.batches import ProbeOfCopies
from tline.solver.many.runs import Many, many

__all__ = ["Many", "ProbeOfCopies", "many"]
