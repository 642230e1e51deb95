"""Accuracy of a scene's run: a tolerance, or order and slab by hand."""

from typing import Annotated

from tline.scene.element import Element, optional
from tline.scene.quantity import Duration, Tolerance, Whole


class Solver(Element):
    """Accuracy of a run, or order and slab width, where they are to be fixed by hand."""

    tol: Tolerance | None = optional("largest error of a probe at slab ends, relative to its amplitude")
    order: Annotated[int, Whole(1, 16)] | None = optional("order of the method, a whole number from 1 to 16")
    slab: Duration | None = optional("width of a time slab, at most the shortest delay")
    rounded: bool = optional(
        "whether delays are rounded to whole slabs, in the first order, as in textbooks: quick where pipes "
        "are many; the tolerance is then of the highest and lowest values at all nodes and probes",
        False,
    )
