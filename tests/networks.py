"""EPANET files for tests: a ring between a reservoir and a tank, with a pump, a valve and an emitter."""

from collections.abc import Mapping
from pathlib import Path

RING = """
[JUNCTIONS]
 suction 2 0
 lift 2 0
 a 20 30
 b 25 40
 c 22 25
 d 20 10
[RESERVOIRS]
 lake 10
[TANKS]
 tower 40 4 0 8 12 0
[PIPES]
 intake lake suction 80 300 {rough} 0.5 Open
 main lift a 900 250 {rough} 2 Open
 ab a b 700 200 {rough} 0 Open
 bc c b 650 150 {rough} 0 Open
 ca c a 800 150 {rough} 1.2 Open
 spare a b 700 100 {rough} 0 Closed
 up b tower 300 250 {rough} 0 CV
[PUMPS]
 duty suction lift HEAD lifting
[VALVES]
 ease a d 100 TCV 12 0
[EMITTERS]
 c 0.4
[CURVES]
 lifting 90 75
[OPTIONS]
 UNITS {units}
 HEADLOSS {law}
 EMITTER EXPONENT {exponent}
[COORDINATES]
 lake 0 0
 suction 10 0
 lift 12 0
 a 100 10
 b 170 20
 c 150 90
 d 100 -40
 tower 200 20
[END]
"""


def ring(
    folder: Path,
    units: str = "LPS",
    law: str = "H-W",
    rough: float = 120,
    exponent: float = 0.5,
    changes: Mapping[str, str] | None = None,
) -> Path:
    """Write the ring to a file, with some texts in it replaced."""
    text = RING.format(units=units, law=law, rough=rough, exponent=exponent)
    for old, new in (changes or {}).items():
        assert old in text
        text = text.replace(old, new)
    path = folder / "ring.inp"
    path.write_text(text)
    return path
