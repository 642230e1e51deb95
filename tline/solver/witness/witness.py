"""The witness of a run to a tolerance: what is given out is held against equations that share nothing with the run."""

from collections.abc import Collection, Iterator
from dataclasses import replace
from itertools import islice

from tline.solver.description.description import Description
from tline.solver.description.short_lines import short_lines
from tline.solver.result.result import Result
from tline.solver.witness.balance import Doubt, balance_doubts, line_doubts
from tline.solver.witness.nodes import lines_at, watched
from tline.solver.witness.plain import plain_doubts
from tline.solver.witness.seen import Seen
from tline.solver.witness.stores import store_doubts


class Witness:
    """Looks at some nodes of a scene; made before its runs, for these keep the waves that it needs.

    Lines that are kept anyway are not lumped; `lines` are those whose waves it needs.
    """

    def __init__(self, description: Description, kept: Collection[str] = ()):
        lumped, _ = short_lines(description, kept)
        self.description, self.nodes = description, watched(description, lumped)
        self.lines = lines_at(self.nodes, description)

    def heard(self, result: Result) -> Result:
        """A result that says where it does not fit the scene's equations: its tolerance is then not met."""
        accuracy = result.accuracy
        if accuracy is None or not accuracy.met:
            return result
        for doubt in islice(self._doubts(result), 1):
            limit = f"two methods disagree at {doubt.where} at {doubt.t:.6g} s: {doubt.what}"
            result = replace(result, accuracy=replace(accuracy, limit=limit))
        return result

    def _doubts(self, result: Result) -> Iterator[Doubt]:
        assert result.accuracy is not None
        assert result.accuracy.tol is not None
        stores = any(one.stores for one in self.nodes)
        seen = Seen(result, self.description, result.accuracy.tol, stores)
        yield from balance_doubts(seen, self.nodes)
        yield from line_doubts(seen)
        yield from store_doubts(seen, self.nodes)
        if self.description.switched or self.description.elements:
            yield from plain_doubts(self.description, result)
