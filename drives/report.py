"""Transfer functions, hidden modes and designs as numbers fit for JSON, and as lines for the eye."""

import math
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drives.control import Design
from drives.modes import HiddenMode
from drives.number import written
from drives.transfer import TransferFunction


def transfer_data(h: TransferFunction) -> dict[str, Any]:
    """A transfer function as numbers; coefficients are fractions as texts, highest power first."""
    return {
        "numerator": [str(c) for c in h.numerator],
        "denominator": [str(c) for c in h.denominator],
        "poles": [pair(z) for z in h.poles],
        "zeros": [pair(z) for z in h.zeros],
        "dc_gain": finite(h.dc_gain),
        "relative_degree": h.relative_degree,
    }


def transfer_text(h: TransferFunction) -> str:
    """A transfer function with its poles, zeros and DC gain in two lines."""
    poles, zeros = (", ".join(map(written, found)) or "none" for found in (h.poles, h.zeros))
    return f"{h}\n  poles {poles} rad/s; zeros {zeros}; DC gain {float(h.dc_gain):.6g}"


def response_data(h: TransferFunction, omega: NDArray) -> dict[str, list[float]]:
    """The Bode plot as numbers."""
    size = h.magnitude(omega)
    decibel, degrees = 20 * np.log10(size), np.degrees(h.phase(omega))
    return {"magnitude": size.tolist(), "decibel": decibel.tolist(), "degrees": degrees.tolist()}


def mode_data(mode: HiddenMode) -> dict[str, Any]:
    """A hidden mode as numbers."""
    return vars(mode) | {"poles": [pair(z) for z in mode.poles]}


def design_data(found: Design) -> dict[str, Any]:
    """A design as numbers."""
    data = {}
    for name, controller in (("speed", found.speed), ("tension", found.tension)):
        margin = found.margins[name]
        data[name] = {
            "gain": float(controller.gain),
            "integral_time": float(controller.integral_time),
            "poles": [pair(z) for z in found.poles[name]],
            "phase_margin_degrees": finite(math.degrees(margin.phase)),
            "crossover": finite(margin.crossover),
            "gain_margin": finite(margin.gain),
            "stable": all(z.real < 0 for z in found.poles[name]),
            "bandwidth": vars(found.bandwidths[name]) if name in found.bandwidths else None,
        }
    return data


def design_text(found: Design) -> list[str]:
    """A design for the eye."""
    lines = []
    for name, controller, plant in (
        ("speed", found.speed, found.speed_plant),
        ("tension", found.tension, found.tension_plant),
    ):
        margin, poles = found.margins[name], ", ".join(written(z) for z in found.poles[name])
        lines += [
            f"{name}: {plant}",
            f"  gain {float(controller.gain):.5g}, integral time {float(controller.integral_time):.5g} s",
            f"  phase margin {math.degrees(margin.phase):.4g}° at {margin.crossover:.4g} rad/s, "
            f"gain margin {margin.gain:.4g}",
            f"  poles {poles} rad/s",
        ]
    return lines


def finite(x: Fraction | float) -> float | None:
    """The number, None in place of an infinity or NaN, which JSON does not have."""
    return float(x) if math.isfinite(x) else None


def pair(z: complex) -> list[float]:
    """Real and imaginary part, for JSON."""
    return [z.real, z.imag]
