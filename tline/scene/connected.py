"""Walk from node to node along pairs."""

from collections import defaultdict
from collections.abc import Container, Iterable


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
