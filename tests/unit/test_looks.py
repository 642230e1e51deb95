"""Places of a slab at which roots are looked for."""

import pytest

from tline.solver.kernel.arithmetic import LOOKS, after


@pytest.mark.parametrize("s", range(1, 17))
def test_each_look_is_beyond_the_last_one(s):
    places = [k / (LOOKS * s) for k in range(LOOKS * s + 1)]
    assert [after(place, s) for place in places[:-1]] == places[1:]
