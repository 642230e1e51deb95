"""Travels of common valves: K over the opening."""

from itertools import pairwise
from math import pi
from typing import Any

import pytest

from tline.errors import SceneError
from tline.scene.valve import ADDED, Orifice, open_loss, opening_of, shares


def valve_of(**given: Any) -> Orifice:
    return Orifice(at="a", **given)


PERRY = [
    ("gate", 0.5, 4.5, 0.17),
    ("globe", 0.75, 13.0, 9.0),
    ("ball", 1 - 40 / 90, 17.3, 0.0),
    ("butterfly", 1 - 20 / 90, 1.54, 0.0),
]


@pytest.mark.parametrize(("kind", "x", "k", "k_open"), PERRY)
@pytest.mark.parametrize("k0", [0.01, 0.3, 9.0])
def test_a_valve_loses_what_the_handbook_says(kind, x, k, k_open, k0):
    valve = valve_of(loss_coefficient=k0, diameter=0.2, characteristic=kind, opening=x)
    share = _share(kind, valve.loss, x)
    assert valve.loss == pytest.approx(k0)
    assert k0 / share**2 == pytest.approx(k0 + k - k_open)


def _share(kind: str, loss: float, x: float) -> float:
    return next(share for opening, share in shares(kind, loss) if opening == pytest.approx(x))


@pytest.mark.parametrize("kind", ADDED)
def test_openings_and_shares_rise_together(kind):
    points = shares(kind, 0.2)
    assert list(points) == sorted(points)
    for x in (0.1, 0.3, 0.6, 0.95):
        (low, below), (high, above) = next(pair for pair in pairwise(points) if pair[1][0] >= x)
        share = below + (x - low) / (high - low) * (above - below)
        assert opening_of(points, share) == pytest.approx(x)
    assert open_loss(kind, 0.05) > open_loss(kind, 1.0) > 0


def test_the_capacity_may_be_given_in_any_way_beside_the_bore():
    by_kv = valve_of(kv=300, diameter=0.1, characteristic="gate")
    assert by_kv.capacity is not None
    by_loss = valve_of(loss_coefficient=by_kv.loss, area=pi / 4 * 0.01, characteristic="gate")
    assert by_loss.capacity == pytest.approx(by_kv.capacity)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"characteristic": "gait", "diameter": 1}, "characteristic: not a kind of valve, expected 'gate' or 'globe'"),
        ({"characteristic": "gate"}, "diameter: is missing, expected the bore of the gate valve"),
        ({"diameter": 1}, "its capacity is not given once"),
    ],
)
def test_mistakes(given, said):
    with pytest.raises(SceneError, match=said):
        valve_of(kv=3, **given)
