"""Cables by their attenuation: against lines whose attenuation is known, and against inverse Laplace."""

import numpy as np
import pytest
from one_line import FAR, one_line

from tline import InputError, Scene, simulate
from tline.frequency.response import respond
from tline.scene.attenuation import DECIBEL, TYPES, Attenuation
from tline.scene.line import Cable
from tline.scene.plausible import plausibility_notes
from tline.study.reference.lossy import Drive, lossy_response

PER = {"dB/100ft": 30.48, "dB/100m": 100.0, "dB/km": 1000.0}  # m


def cable(t_end="2 us", **line) -> Scene:
    return one_line(t_end, {"length": "100 m"} | line, 1, 50, 50, probes=FAR)


@pytest.mark.parametrize(("skin", "tangent"), [(2.0, 4e-4), (2.0, None), (0.1, 4e-3)])
def test_points_of_a_line_give_that_line(skin, tangent):
    """Attenuations computed from R, G, L and C at some frequencies; the same law of insulation, with its band."""
    f = np.array([1e6, 1e7, 1e8, 1e9])
    band = {"frequency": float(np.sqrt(f[0] * f[-1])), "low": f[0] / 1e3, "high": f[-1] * 1e3}
    losses = {"skin": {"resistance": skin, "frequency": 1e8}}
    losses |= {"loss_tangent": {"value": tangent} | band} if tangent else {}
    known = cable(z0=50, wave_speed=2e8, **losses).lines["line"].losses.exact
    nepers = [complex(known.gamma(2j * np.pi * x)).real for x in f]
    points = [[float(x), float(a * DECIBEL * 100)] for x, a in zip(f, nepers, strict=True)]
    found = cable(z0=50, wave_speed=2e8, attenuation={"unit": "dB/100m", "points": points}).lines["line"]
    assert found.attenuation_residual < 1e-9
    for x in (3e5, 3e7, 3e9):
        one, other = (complex(line.gamma(2j * np.pi * x)) for line in (known, found.losses.exact))
        assert abs(one - other) < 1e-8 * abs(one)


@pytest.mark.parametrize("name", TYPES)
def test_named_cables_have_all_digits_of_their_table(name):
    scene, kind = cable(cable=name), TYPES[name]
    line = scene.lines["line"]
    assert 0 < line.attenuation_residual < 0.02
    assert any("of the data sheet's" in note for note in plausibility_notes(scene))
    table = Attenuation.model_validate({"unit": kind.unit, "points": kind.points})
    for f, (_, printed) in zip(table.frequencies, kind.points, strict=True):
        decibels = complex(line.losses.exact.gamma(2j * np.pi * f)).real * DECIBEL * PER[kind.unit]
        assert round(decibels, len(str(printed).partition(".")[2])) == printed


def test_resistances_to_steady_current_are_found_where_the_digits_need_them():
    """Computed from R of 30 mohm/m that becomes skin effect and 20 mohm/m beside it; told with five digits."""
    f = np.array([1e5, 3e5, 1e6, 3e6, 1e7, 1e8])
    losses = ({"resistance": 0.03, "skin": {"resistance": 0.5, "frequency": 1e7}}, {"resistance": 0.02})
    s = 2j * np.pi * f
    lines = [Cable(nodes=("a", "b"), z0=50, wave_speed=2e8, length=1, **each).losses.exact for each in losses]
    Z = sum(line.series.at(s) for line in lines) - s * 50 / 2e8
    nepers = np.sqrt(Z * s / (50 * 2e8)).real
    points = [[float(x), round(float(a * DECIBEL * 100), 5)] for x, a in zip(f, nepers, strict=True)]
    table = Attenuation.model_validate({"unit": "dB/100m", "points": points})
    (skin, beside), _ = table.laws(50, 2e8)
    assert skin.loss + beside.loss == pytest.approx(0.05, rel=0.1)
    assert table.residual(50, 2e8) < 2e-4


def test_a_guessed_resistance_to_steady_current_is_told():
    """Of LMR-400, Times Microwave has 1.39 and 1.65 ohm per 1000 ft for its two conductors."""
    guess = "is a guess from its attenuation"
    assert any("0.0894 ohm/m, " + guess in note for note in plausibility_notes(cable(cable="RG-58")))
    known = cable(cable="LMR-400")
    assert known.lines["line"].losses.exact.series.at(0).real == pytest.approx(3.04 / 304.8, rel=1e-9)
    assert not any(guess in note for note in plausibility_notes(known))
    law, kind = known.lines["line"].losses.exact, TYPES["LMR-400"]
    for f, printed in zip((30e6, 50e6, 150e6, 450e6, 900e6), [a for _, a in kind.points], strict=True):
        decibels = complex(law.gamma(2j * np.pi * f)).real * DECIBEL * PER[kind.unit]
        assert round(decibels, len(str(printed).partition(".")[2])) == printed


def test_a_matched_end_sees_that_attenuation():
    scene = cable(
        z0=50, velocity_factor=0.66, attenuation={"unit": "dB/100m", "points": [["100 MHz", 16], ["1 GHz", 61]]}
    )
    far = respond(scene, 2j * np.pi * 1e8, "s")["far"].u
    assert -20 * np.log10(2 * abs(far)) == pytest.approx(16.0, abs=0.02)  # and what the end sends back


def test_the_step_response_of_a_hundred_metres():
    scene = cable(cable="RG-58")
    line, delay = scene.lines["line"].losses.exact, scene.lines["line"].parameters.delay
    result = simulate(scene.with_changes(solver={"order": 8, "slab": delay / 100}))
    t = delay * np.array([1.03, 1.05, 1.1, 1.2, 1.5, 2, 2.9, 3.05, 3.5])
    exact = lossy_response(
        line, [repr(float(x)) for x in t], line.length, source=50.0, load=50.0, digits=10, drive=Drive.STEP
    )
    assert np.abs(result.probes["far"].at(t).u - [float(u) for u in exact.u]).max() < 1e-6


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ({"cable": "RG58"}, "lines.line.cable: not known here, expected 'RG-58', got 'RG58'"),
        ({"cable": "RG-58", "z0": 50}, "lines.line.z0: follows from the cable's name, too, expected one of them"),
        ({"z0": 50, "wave_speed": 2e8, "attenuation": {"points": [[1e6, 1]]}}, "lines.line.attenuation.points: "),
        ({"z0": 50, "wave_speed": 2e8, "attenuation": {"points": [[1e6, 1], [1e5, 2]]}},
         "lines.line.attenuation.points[1]: frequencies do not ascend"),
        ({"z0": 50, "wave_speed": 2e8, "attenuation": {"unit": "dB/yd", "points": [[1e6, 1], [1e7, 2]]}},
         "lines.line.attenuation.unit: not known here, expected dB/m, dB/100m"),
        ({"z0": 50, "wave_speed": 2e8, "attenuation": {"unit": "dB/00m", "points": [[1e6, 1], [1e7, 2]]}},
         "lines.line.attenuation.unit: not known here, expected dB/m, dB/100m"),
        ({"z0": 50, "wave_speed": 2e8, "attenuation": {"points": [[1e6, "1 dB/m"], [1e7, 2]]}},
         "lines.line.attenuation.points[0]: not decibels alone"),
        ({"z0": 50, "wave_speed": 2e8, "attenuation": {"unit": "dB/100m", "points": [[10, 4.6], [100, 15.9]]}},
         "lines.line.attenuation.points: belong to no line of that z0 and speed"),
        ({"cable": "RG-58", "skin": {"resistance": 1, "frequency": 1e9}},
         "lines.line.skin: is a loss that the attenuation has, too"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_sentence(line, sentence):
    with pytest.raises(InputError) as found:
        cable(**line)
    assert str(found.value).startswith(sentence)


@pytest.mark.parametrize(
    ("unit", "metres"),
    [
        ("dB/100 m", 100),
        ("db / 100 ft", 30.48),
        ("dB/kft", 304.8),
        ("dB/1000ft", 304.8),
        ("dB/mi", 1609.344),
        ("dB/km", 1000),
    ],
)
def test_decibels_are_per_any_length(unit, metres):
    points = [["10 MHz", "1.5 dB"], ["100 MHz", 4.9]]
    np.testing.assert_allclose(Attenuation(unit=unit, points=points).nepers * 20 / np.log(10) * metres, [1.5, 4.9])
