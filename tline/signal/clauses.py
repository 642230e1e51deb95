"""Parameters of a channel operating margin: those of a clause of IEEE Std 802.3, or of a file."""

import json
from itertools import product
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tline.errors import InputError
from tline.scene.element import Element
from tline.scene.quantity import Quantity, Role, Whole
from tline.scene.text_file import read_text, read_toml
from tline.words.wording import nearest, shown

Ohm = Annotated[Quantity, Role("resistance", "ohm", above=0)]
Farad = Annotated[Quantity, Role("capacitance", "F", at_least=0)]
Length = Annotated[Quantity, Role("length", "m", at_least=0, at_most=10)]
Volt = Annotated[Quantity, Role("amplitude", "V", above=0)]
Frequency = Annotated[Quantity, Role("frequency over f_b", "", at_least=1e-6, at_most=100)]
Share = Annotated[Quantity, Role("ratio", "", at_least=0, at_most=1)]
Mismatch = Annotated[Quantity, Role("ratio of level mismatch", "", above=0, at_most=1)]
Decibels = Annotated[Quantity, Role("decibels", "", at_least=-100, at_most=100)]
Tap = Annotated[Quantity, Role("tap", "", at_least=-1, at_most=1)]
Loss = Annotated[Quantity, Role("attenuation", "", at_least=0, at_most=1)]
PerMetre = Annotated[Quantity, Role("time per length", "s/m", at_least=0, at_most=1e-6)]
ONE, ZERO, MM_12 = Quantity(1, ""), Quantity(0, ""), Quantity("12 mm", "m")
TAPS = {f"c({k})": k for k in (*range(-9, 0), *range(1, 10))}
MOST = 50_000  # settings of the sender's taps
SAMPLES = 100_000_000  # of all settings together
GAINS = 10_000  # settings of both gains


class LossyLine(Element):
    """A differential line by Z_c, gamma_0 in 1/mm, a_1 in ns^(1/2)/mm, a_2 and tau, as of table 93A-3 if not given.

    With f in GHz its propagation constant is gamma_0 + a_1 (1 + j) √f + a_2 f (1 - j 2/π ln f) + j 2π tau f,
    by (93A-9) to (93A-14).
    """

    Z_c: Ohm
    gamma_0: Loss = ZERO
    a_1: Loss = Quantity(1.734e-3, "")
    a_2: PerMetre = Quantity("1.455e-4 ns/mm", "s/m")
    tau: PerMetre = Quantity("6.141e-3 ns/mm", "s/m")

    def behind(self, f: NDArray, length: float, v: NDArray, z: NDArray) -> tuple[NDArray, NDArray]:
        """Open voltage and impedance, at the other end of the line, of a source v behind z."""
        x, log = f / 1e9, np.log(np.maximum(f / 1e9, 1e-300))
        by_f = 1e6 * (float(self.a_2) * (1 - 2j / np.pi * log) + 2j * np.pi * float(self.tau))
        gamma = 1e3 * length * (float(self.gamma_0) + float(self.a_1) * (1 + 1j) * np.sqrt(x) + by_f * x)
        e, own = np.exp(-gamma), float(self.Z_c)  # of cosh and sinh, which overflow
        divided = 1 + e**2 + z / own * (1 - e**2)
        return 2 * v * e / divided, (z * (1 + e**2) + own * (1 - e**2)) / divided


class Package(LossyLine):
    """Package of a device: C_d of each conductor at its die, a line, C_p at the board.

    For each test case z_p has the length of all devices' lines but near-end aggressors', and of theirs.
    """

    C_d: Farad
    C_p: Farad
    z_p: tuple[tuple[Length, Length], ...] = Field(
        default=((MM_12, MM_12), (Quantity("30 mm", "m"), MM_12)), min_length=1
    )


class Board(LossyLine):
    """Boards of hosts at both ends of a cable, with lengths as of table 92-12 if not given."""

    z_tx: Length = Quantity("151 mm", "m")
    z_rx: Length = Quantity("151 mm", "m")
    z_fext: Length = Quantity("72 mm", "m")
    z_next: Length = Quantity("72 mm", "m")


class Clause(Element):
    """Parameters with the symbols of IEEE Std 802.3, table 93A-1; frequencies but f_b and delta_f are multiples of f_b.

    Ranges are least, most, step, those of gains in dB. Capacitances and R_d are of each conductor. Edges are steep
    without T_r, from 20 to 80 %; the equaliser has no second stage without f_LF. The last of b_max holds for all
    further taps; `least` is the margin that passes, dB.
    """

    title: str = ""
    f_b: Annotated[Quantity, Role("signaling rate", "Hz", above=0, at_most=2e11)]
    delta_f: Annotated[Quantity, Role("frequency", "Hz", at_least=4e6)] = Quantity("10 MHz", "Hz")
    L: Annotated[int, Whole(2, 16)] = 2
    R_LM: Mismatch = ONE
    M: Annotated[int, Whole(8, 128)] = 32
    R_d: Ohm = Quantity("55 ohm", "ohm")
    A_v: Volt = Quantity("0.4 V", "V")
    A_fe: Volt = Quantity("0.4 V", "V")
    A_ne: Volt = Quantity("0.6 V", "V")
    T_r: Annotated[Quantity, Role("time", "s", at_least=0)] = Quantity(0, "s")
    f_r: Frequency = Quantity(0.75, "")
    g_DC: tuple[Decibels, Decibels, Decibels]
    f_z: Frequency
    f_p: tuple[Frequency, ...] = Field(min_length=1)
    g_DC2: tuple[Decibels, Decibels, Decibels] = (ZERO, ZERO, ONE)
    f_LF: Frequency | None = None
    ffe: dict[str, tuple[Tap, Tap, Tap]] = Field(default_factory=dict)
    c_0: Share = ZERO
    N_b: Annotated[int, Whole(0, 200)]
    b_max: tuple[Share, ...] = Field(default=(ONE,), min_length=1)
    sigma_RJ: Share
    A_DD: Share
    eta_0: Annotated[Quantity, Role("noise density", "V^2/Hz", at_least=0)]
    SNR_TX: Decibels
    DER_0: Annotated[Quantity, Role("error ratio", "", at_least=1e-15, at_most=0.1)]
    least: Decibels = Quantity(3, "")
    package: Package
    board: Board | None = None

    @model_validator(mode="after")
    def _are_used(self):
        if self.f_LF is None and any(self.g_DC2[:2]):
            raise InputError("f_LF", "is missing", "the frequency of the stage with the gains g_DC2")
        if len(self.b_max) > max(self.N_b, 1):
            raise InputError("b_max", "longer than the feedback", f"at most {self.N_b} of N_b", f"{len(self.b_max)}")
        return self

    @property
    def taps(self) -> tuple[NDArray, int]:
        """All settings of the sender's taps in order of time, shape (n, m), and which is the main one."""
        if wrong := self.ffe.keys() - TAPS:
            raise InputError(
                "Clause.ffe", "not a tap beside the main one", "such as 'c(-1)' or 'c(1)'", shown(min(wrong))
            )
        ranges = {TAPS[name]: _steps(each, f"Clause.ffe.{name}") for name, each in self.ffe.items()}
        lead, last = -min([0, *ranges]), max([0, *ranges])
        most = min(MOST, SAMPLES // (self.M * (self.N_b + 2 * (lead + last) + 8)))
        if (settings := float(np.prod([float(len(each)) for each in ranges.values()]))) > most:
            expected = f"at most {most:,} with this M and N_b"
            raise InputError("Clause.ffe", "too many settings", expected, f"{settings:g}")
        found = np.array([*product(*(ranges.get(k, [0.0]) for k in range(-lead, last + 1)))])
        found[:, lead] = 1 - np.abs(found).sum(axis=1)
        found = found[found[:, lead] >= float(self.c_0) - 1e-9]
        if not len(found):
            raise InputError(
                "Clause.c_0", "larger than the main tap of all settings", "1 less the moduli of the others"
            )
        return found, lead

    @property
    def gains(self) -> list[tuple[float, float]]:
        """All gains at rest of both stages of the receiver's equaliser, dB."""
        second = _steps(self.g_DC2, "Clause.g_DC2") if self.f_LF else np.zeros(1)
        first = _steps(self.g_DC, "Clause.g_DC")
        if len(first) * len(second) > GAINS:
            got = f"{len(first) * len(second):,}"
            raise InputError("Clause.g_DC2", "too many settings with those of g_DC", f"at most {GAINS:,}", got)
        return [*product(first.tolist(), second.tolist())]


def _steps(limits: tuple[float, float, float], where: str) -> NDArray:
    least, most, step = map(float, limits)
    if not least <= most or not step > 0 or (most - least) / step > 1000:
        raise InputError(where, "not a range", "least, most, and a step above 0, at most 1000 of them", f"{limits}")
    return least + step * np.arange(int((most - least) / step + 1e-9) + 1)


def clause(named: "str | Path | dict[str, Any] | Clause") -> Clause:
    """Parameters of a channel operating margin.

    Parameters
    ----------
    named : str, Path, dict or Clause
        A name as ``"100GBASE-KR4"``, a TOML or JSON file or a table with keys of `Clause`, where ``base`` names the
        clause of all that is not given, inside ``package`` and ``board`` too.

    Raises
    ------
    InputError
        No such clause or file, or every mistake in its keys.

    Examples
    --------
    >>> kr4 = clause("100GBASE-KR4")
    >>> float(kr4.f_b), kr4.N_b, len(kr4.taps[0]), len(kr4.gains)
    (25781250000.0, 14, 155, 13)
    >>> clause({"base": "100GBASE-KR4", "DER_0": 1e-12}).table()["DER_0"]
    1e-12
    """
    if isinstance(named, Clause):
        return named
    known = read_toml(Path(__file__).with_name("clauses.toml"), "parameters by clause")
    table: Any = named if isinstance(named, dict) else {"base": str(named)}
    if str(named).endswith(".toml"):
        table = read_toml(Path(str(named)), "parameters")
    elif str(named).endswith(".json"):
        text = read_text(Path(str(named)))
        try:
            table = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InputError(str(named), f"is no JSON: {error!s:.200}", "a table with keys such as f_b") from None
        if not isinstance(table, dict):
            raise InputError(str(named), "is no table in JSON", "keys such as f_b", shown(text))
    while "base" in table:
        if (base := str(table["base"])) not in known:
            raise InputError("clause", "not known", f"{nearest(base, [*known])}, or a .toml or .json file", shown(base))
        own = {key: value for key, value in table.items() if key != "base"}
        own |= {
            key: known[base].get(key, {}) | own[key] for key in ("package", "board") if isinstance(own.get(key), dict)
        }
        table = known[base] | own
    return Clause(**table)
