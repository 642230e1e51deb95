"""Statistical eyes compared with ten million bits added up one by one: ``python -m benchmarks.eyes``.

Compared are levels that a share of ones falls below, with Gaussian noise.
"""

from time import process_time

import numpy as np
from scipy.signal import oaconvolve

from benchmarks.harness import ROOT, table, write
from tline.signal import best_ffe, measured_channel, pulse_response, statistical_eye
from tline.signal.bits import FINE
from tline.signal.pulse import PulseResponse

BITS, RATES = 10_000_000, (1e-2, 1e-3, 1e-4, 1e-5)
NOISE = 3e-3  # V


def channels() -> dict[str, PulseResponse]:
    """Pulses of 30 cm of stripline, equalised or not, and of a measured filter."""
    strip = pulse_response(str(ROOT / "scenes/stripline_eye.toml"), "receiver", "60 ps", "20 ps", tol=1e-4)
    measured = measured_channel(ROOT / "scenes/filter.s2p").pulse("0.4 ns", "0.1 ns")
    return {
        "stripline, 60 ps": strip,
        "with 1 + 2 taps": strip.with_ffe(best_ffe(strip, 1, 2)),
        "with -6 dB, 2, 5 and 15 GHz": strip.with_ctle(-6, 2e9, 5e9, 15e9),
        "filter, 0.4 ns": measured,
    }


def rows() -> list[list[str]]:
    """Level of ones by both methods, for each channel and share."""
    rng, found = np.random.default_rng(1), []
    bits = rng.integers(0, 2, BITS)
    for name, pulse in channels().items():
        begun = process_time()
        seen = {rate: statistical_eye(pulse, rate, noise=NOISE) for rate in RATES}
        ours, begun = process_time() - begun, process_time()
        eye = seen[RATES[0]]
        at = round(eye.instant / pulse.period * FINE)
        u = pulse.base + oaconvolve(bits, pulse.u.ravel()[at % FINE :: FINE])[at // FINE :][:BITS]
        u += NOISE * rng.normal(size=BITS)
        ones = np.sort(u[1000:-1000][bits[1000:-1000] == 1])
        theirs = process_time() - begun
        for rate in RATES:
            level = float(np.quantile(ones, rate))
            told = float(seen[rate].ones[FINE // 2])
            swing = float(eye.levels[-1] - eye.levels[0])
            off = f"{abs(told - level) / swing:.0e}"
            found.append([name, f"{rate:g}", f"{told:.5f}", f"{level:.5f}", off])
        found[-len(RATES)] += [f"{ours / len(RATES):.2f}", f"{theirs:.1f}"]
    return [row + [""] * (7 - len(row)) for row in found]


if __name__ == "__main__":
    told = f"""# Statistical eyes beside {BITS:,} bits

Written by `python -m benchmarks.eyes`. The level that a share of ones falls below at the sampling instant, with noise
of {NOISE:g} V; of the last share there are 50. CPU times are of one eye and of the bits."""
    head = "<channel|share|level, V|of bits, V|off, of swing|s|bits, s"
    write("benchmarks/pages/eyes.md", f"{told}\n\n{table(head, rows())}\n")
