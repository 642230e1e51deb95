"""Many runs of one scene in one call, with numbers that vary from copy to copy."""

from tline.solver.many.many import Many, Seen, many

__all__ = ["Many", "Seen", "many"]
