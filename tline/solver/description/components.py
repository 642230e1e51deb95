"""What hangs together."""

import numpy as np
from numpy.typing import NDArray


def parts(first: NDArray, second: NDArray, n: int) -> NDArray:
    """Number of the connected part that each of n nodes lies in, for lines from the first nodes to the second."""
    label, before = np.arange(n), np.full(n, -1)  # the least node of a part gives it its label, along the lines
    while (label != before).any():
        before = label.copy()
        least = np.minimum(label[first], label[second])
        np.minimum.at(label, first, least)
        np.minimum.at(label, second, least)
        label = label[label]
    return np.unique(label, return_inverse=True)[1]
