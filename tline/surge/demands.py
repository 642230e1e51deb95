"""Several changes of what one node draws, such as the rise and the fall of a pulse, as one."""

from collections import defaultdict
from collections.abc import Iterable
from itertools import accumulate, pairwise

from tline.errors import InputError
from tline.surge.event import Event


def as_one_each(events: Iterable[Event]) -> list[Event]:
    """The events, with those on the demand of one node as one event with a course of its share.

    Examples
    --------
    >>> rise, fall = Event("demand", "b", 1.0, 0.5, 0.005), Event("demand", "b", 4.0, 0.0, -0.005)
    >>> as_one_each([rise, fall])[0].course
    ((0.0, 0.0), (0.5, 1.0), (3.0, 1.0), (3.0, 0.0))
    """
    changes, rest = defaultdict[str, list[Event]](list), list[Event]()
    for event in events:
        (changes[event.name] if event.kind == "demand" else rest).append(event)
    return [*rest, *(_as_one(sorted(each, key=lambda event: event.at)) for each in changes.values())]


def _as_one(events: list[Event]) -> Event:
    first = events[0]
    if len(events) == 1:
        return first
    for one, two in pairwise(events):
        if two.at < one.at + one.duration or two.at == one.at:
            raise InputError("demand", f"changes at '{first.name}' overlap", "one after the other", f"{two.at:g} s")
    flows = [0.0, *accumulate(event.flow for event in events)]
    peak = max(flows, key=abs)
    shares = [round(flow / peak, 12) + 0.0 for flow in flows]  # no rounding of sums, and no -0.0
    if min(shares) < 0:
        problem = f"changes at '{first.name}' lead above and below what it drew"
        raise InputError("demand", problem, "sums that are all above, or all below")
    course = [
        (t - first.at, share)
        for event, sides in zip(events, pairwise(shares), strict=True)
        for t, share in zip((event.at, event.at + event.duration), sides, strict=True)
    ]
    return first._replace(duration=0.0, flow=peak, course=tuple(course))
