"""Nodes that pairs connect: by a walk from some of them, or joined one after the other."""

from collections import defaultdict
from collections.abc import Container, Iterable
from typing import Any


def connected(begin: Iterable[str], pairs: Iterable[Iterable[str]], within: Container[str] | None = None) -> set[str]:
    """Nodes that pairs connect with the first ones, these among them; others only if they are `within`.

    Examples
    --------
    >>> sorted(connected("a", [("a", "b"), ("c", "b"), ("d", "e")]))
    ['a', 'b', 'c']
    """
    beside = defaultdict[str, list[str]](list)
    for one, two in pairs:
        beside[one].append(two)
        beside[two].append(one)
    found, new = set(begin), list(begin)
    while new:
        new = [*{other for node in new for other in beside[node] if within is None or other in within} - found]
        found |= {*new}
    return found


class Joined(dict[Any, Any]):
    """Nodes joined to groups; each leads to another of its group, but the root of the group to itself."""

    def root(self, node: Any) -> Any:
        """Node that stands for the group of another."""
        while (above := self.setdefault(node, node)) != node:
            self[node] = node = self[above]
        return node

    def join(self, first: Any, *others: Any) -> None:
        """Join the groups of some nodes."""
        root = self.root(first)
        for node in others:
            self[self.root(node)] = root
