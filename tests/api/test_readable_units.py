"""Results are read in the units of the user, or of the file that a network comes from: the same numbers in others."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tline as tl
from tline.errors import InputError, LeftOutWarning
from tline.solver.result.export import save_envelope
from tline.surge.operation import operate
from tline.units import to_si

TOWN = Path(__file__).parents[2] / "scenes" / "town.inp"


@pytest.fixture(scope="module")
def towns():
    scene = tl.read(TOWN.with_suffix(".toml"))
    calm = {"links.duty": scene.table()["links"]["duty"] | {"speed": 1}}
    given: Any = {
        "trip": "duty@0.5s",
        "inertia": "0.4 kg m^2",
        "rated_speed": "1450 rpm",
        "t_end": "2 s",
        "seconds": 600,
    }
    return {units: operate(scene.change(calm), units=units, **given) for units in ("SI", "US, m3/h")}


def columns(path: Path) -> tuple[list[str], np.ndarray]:
    """Units of a table's columns, and its numbers."""
    with path.open() as file:
        head, *rows = csv.reader(file)
    skip = int(head[0] == "node")
    return [name.partition("[")[2].rstrip("]") for name in head[skip:]], np.array([row[skip:] for row in rows], float)


def test_tables_are_the_same_in_other_units(towns, tmp_path):
    written = []
    for surge in towns.values():
        surge.result.save(tmp_path / "probes.csv")
        save_envelope(surge.result, tmp_path / "nodes.csv")
        written.append([columns(tmp_path / name) for name in ("probes.csv", "nodes.csv")])
    for (_, si), (units, us) in zip(*written, strict=True):
        assert {"psi", "ft"} <= {*units}
        np.testing.assert_allclose(us * [to_si(f"1 {unit}", None) for unit in units], si, rtol=1e-13, atol=1e-9)


def test_the_report_says_psi_and_the_same_numbers(towns):
    bar, psi = (str(surge) for surge in towns.values())
    assert "before [psi]" in psi
    assert "bar" not in psi
    top = towns["SI"].worst.highest.highest
    assert f"the highest pressure, {top / 1e5:.4g} bar" in bar
    assert f"the highest pressure, {top / to_si('1 psi', 'Pa'):.4g} psi" in psi
    one, other = (surge.to_dict() for surge in towns.values())
    assert one | {"notes": []} == other | {"notes": []}  # in SI, whatever people read


def test_pictures_have_the_units(towns):
    surge = towns["US, m3/h"]
    labels = [axes.get_ylabel() for axes in surge.plot().axes]
    assert any("[psi]" in label for label in labels)
    assert any("[m3/h]" in label for label in labels)
    profile = surge.plot_profile("lake", "tower").axes[0]
    assert (profile.get_ylabel(), profile.get_xlabel()) == ("head [ft]", "distance from lake [ft]")


@pytest.mark.parametrize(
    ("given", "units"), [("GPM", "US"), ("CFS", "US, ft^3/s"), ("LPS", "SI"), ("CMH", "SI, m^3/h"), ("MGD", "US, MGD")]
)
def test_an_imported_network_has_the_units_of_its_file(given, units, tmp_path):
    pytest.importorskip("wntr")
    file = tmp_path / "town.inp"
    file.write_text(TOWN.read_text().replace("LPS", given))
    with pytest.warns(LeftOutWarning):
        assert tl.read(file).units == units


def test_what_is_no_unit_of_results_is_refused():
    with pytest.raises(InputError, match=r"units: no unit that results have.* 'furlong'"):
        operate(TOWN.with_suffix(".toml"), units="US, furlong", close="ease@1s")
