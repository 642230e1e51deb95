"""Names of inputs and outputs that a user may give."""

from collections.abc import Sequence

from tline.errors import InputError


def known_names(where: str, given: Sequence[str], known: Sequence[str]) -> None:
    """Refuse names that are not known, and no names at all."""
    if isinstance(given, str) or not given:
        raise InputError(where, "no names", f"some of {', '.join(known)}", repr(given)[:40])
    for name in given:
        if name not in known:
            raise InputError(where, "unknown name", " or ".join(known), repr(name)[:40])
