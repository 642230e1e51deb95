"""Drivers and receivers from IBIS files: the file's keywords, a model at a corner, its switching, a load of a scene."""


def die_of(name: str) -> str:
    """Name of the node between the package of a load and its die."""
    return f"{name}, die"
