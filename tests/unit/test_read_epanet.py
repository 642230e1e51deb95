"""What an EPANET file may hold, and what is said of files that are none."""

import pytest
from networks import ring

from tline.errors import InputError
from tline.interchange import confined
from tline.interchange.epanet import read_epanet
from tline.interchange.water_network import pump_curve


def test_without_wntr_it_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setattr(confined, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"wntr is missing.*'\.\[epanet\]'"):
        read_epanet(ring(tmp_path))


@pytest.mark.parametrize(
    "points", [[], [(0.0, 5.0)], [(0.1, 5.0), (0.2, 6.0)], [(0.1, 5.0), (0.1, 4.0)], [(0.1, -5.0)]]
)
def test_pump_curves_that_do_not_fall(points):
    with pytest.raises(InputError, match="does not fall"):
        pump_curve(points)


class TestWithWntr:
    @pytest.fixture(autouse=True)
    def _installed(self):
        pytest.importorskip("wntr")

    def test_a_line_ends_at_a_null_character(self, tmp_path):
        path = ring(tmp_path)
        whole = read_epanet(path)
        with open(path, "rb") as file:
            data = file.read()
        padded = data.replace(b"[PIPES]\n", b"[PIPES]\0\0[PUMPS]\n") + b"\0" * 100
        assert padded.count(b"\0") == 102
        with open(path, "wb") as file:
            file.write(padded)
        assert read_epanet(path) == whole

    def test_what_epanet_2_3_writes_beside(self, tmp_path):
        whole = read_epanet(ring(tmp_path))
        newer = "[LEAKAGE]\n[CONTROLS]\n LINK spare OPEN AT TIME 0 Disabled\n[COORDINATES]"
        assert read_epanet(ring(tmp_path, changes={"[COORDINATES]": newer})).pipes == whole.pipes
        with pytest.raises(InputError, match="line 34: leakage along a pipe is not computed"):
            read_epanet(ring(tmp_path, changes={"[COORDINATES]": "[LEAKAGE]\n ab 2 0.1\n[COORDINATES]"}))

    def test_open_links_and_their_nodes(self, tmp_path):
        network = read_epanet(ring(tmp_path))
        assert set(network.nodes) == {"lake", "suction", "lift", "a", "b", "c", "d", "tower"}
        assert (set(network.pipes), set(network.pumps), set(network.valves)) == (
            {"intake", "main", "ab", "bc", "ca", "up"},
            {"duty"},
            {"ease"},
        )
        assert network.notes == ("left out, closed or without flow: 'spare'",)
        pipe = network.pipes["up"]
        assert (pipe.nodes, pipe.length, pipe.diameter, pipe.one_way) == (("b", "tower"), 300.0, 0.25, True)
        assert pipe.flow > 0
        tower = network.basins["tower"]
        assert (tower.kind, tower.elevation, tower.head) == ("tank", 40.0, pytest.approx(44.0, rel=1e-6))
        assert network.junctions["b"].demand == pytest.approx(0.04, rel=1e-6)
        assert network.junctions["c"].demand == pytest.approx(0.025, rel=1e-5)
        assert network.junctions["c"].emitter == pytest.approx(0.4e-3, rel=1e-12)
        assert network.junctions["d"].position == (100.0, -40.0)
        valve = network.valves["ease"]
        assert (valve.kind, valve.flow) == ("TCV", pytest.approx(0.01, rel=1e-5))
        # a loss of 12 velocity heads; EPANET rounds 8/(π²·32.2) to 0.02517
        assert valve.drop == pytest.approx(12 * (0.01 / (3.14159265 / 4 * 0.01)) ** 2 / (2 * 9.81456), rel=2e-4)

    def test_a_pump_that_is_off_and_what_hangs_on_it_alone(self, tmp_path):
        changes = {
            " up b tower 300 250 120 0 CV": " up b tower 300 250 120 0 Closed",
            "HEAD lifting": "HEAD lifting SPEED 0",
        }
        network = read_epanet(ring(tmp_path, changes=changes))
        assert set(network.nodes) == {"lake", "suction"}
        assert any("no open link leads there" in note and "'tower'" in note for note in network.notes)

    def test_controls_and_patterns_count_at_the_start(self, tmp_path):
        text = "[PATTERNS]\n day 0.5 2\n[CONTROLS]\n LINK spare OPEN AT TIME 0\n[COORDINATES]"
        changes = {" b 25 40": " b 25 40 day", "[COORDINATES]": text}
        network = read_epanet(ring(tmp_path, changes=changes))
        assert "spare" in network.pipes
        assert network.junctions["b"].demand == pytest.approx(0.02, rel=1e-6)
        assert network.notes == ("patterns, controls and rules: as they stand at the start of time",)

    @pytest.mark.parametrize(
        ("changes", "said"),
        [
            ({"[PIPES]": "[PIPE DREAMS]"}, "PIPE DREAMS"),
            ({" main lift a": " main lift nowhere"}, "nowhere"),
            ({"lifting 90 75": "lifting 90 75\n lifting 100 80"}, "invalid head curve for pump duty"),
            ({"900 250": "long 250"}, "long"),
        ],
    )
    def test_broken_files(self, tmp_path, changes, said):
        with pytest.raises(InputError, match=said) as caught:
            read_epanet(ring(tmp_path, changes=changes))
        assert "\n" not in str(caught.value)

    def test_files_that_are_not_there_or_no_text(self, tmp_path):
        with pytest.raises(InputError, match=r"cannot be read.*[Nn]o such file"):
            read_epanet(tmp_path / "nothing.inp")
        (tmp_path / "noise.inp").write_bytes(bytes(range(256)))
        with pytest.raises(InputError, match="cannot be read"):
            read_epanet(tmp_path / "noise.inp")
        (tmp_path / "empty.inp").write_text("")
        with pytest.raises(InputError):
            read_epanet(tmp_path / "empty.inp")
