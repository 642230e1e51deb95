"""The electrical scenes with circuits, their equations written by hand: the numbers stand here a second time."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from method_of_steps import ByHand, Line, Motion, integrate
from numpy.typing import NDArray

THERMAL = 1.380649e-23 * 300.15 / 1.602176634e-19  # V
NS, US, PF = 1e-9, 1e-6, 1e-12
NONE = np.zeros(1)  # the rate of a state that is not there


class Pulses(NamedTuple):
    """Trapezoids."""

    high: float
    at: float
    rise: float
    width: float
    period: float = np.inf

    def __call__(self, t: float) -> float:
        t -= self.at
        phase = t % self.period if np.isfinite(self.period) else t
        corners = np.cumsum([0, self.rise, self.width, self.rise])
        return float(np.interp(phase, corners, [0, self.high, self.high, 0])) if t > 0 else 0.0

    def corners(self, t_end: float) -> tuple[float, ...]:
        one = np.cumsum([self.at, self.rise, self.width, self.rise])
        periods = np.arange(np.ceil(t_end / self.period)) * self.period if np.isfinite(self.period) else [0.0]
        return tuple(float(t) for start in periods for t in one + start if t < t_end)


class Table(NamedTuple):
    """Straight pieces of a current over voltage, continued beyond the last."""

    u: NDArray
    i: NDArray

    def piece(self, k: int) -> tuple[float, float]:
        """Slope g and offset j of i = g u + j."""
        g = (self.i[k + 1] - self.i[k]) / (self.u[k + 1] - self.u[k])
        return g, self.i[k] - g * self.u[k]

    def edges(self, k: int, u: float) -> tuple[float, float]:
        last = len(self.u) - 2
        return (self.u[k + 1] - u if k < last else np.inf, u - self.u[k] if k else np.inf)


def behind(e: float, r: float, w: float, z0: float = 50.0) -> float:
    """Effort where a source e behind r feeds a line."""
    return (e * z0 + w * r) / (r + z0)


def ddr_receiver() -> Motion:
    """A table drives a line into C u' = (w - u)/z0 - diodes."""
    data, z0, c, saturation, supply = Pulses(1.2, 0.2 * NS, 0.2 * NS, 1.4 * NS, 3.2 * NS), 50.0, 1.5 * PF, 1e-9, 1.2
    table = Table(np.array([-1.2, -0.4, 0.4, 1.2]), np.array([-34e-3, -20e-3, 20e-3, 34e-3]))

    def drop(t, w, k):
        g, j = table.piece(k)
        return (data(t) - w - z0 * j) / (1 + z0 * g)

    def circuit(t, x, w, mode):
        u = min(max(x[0], -1.5), 2.7)  # a step that is tried may go far
        diodes = saturation * (np.expm1((u - supply) / THERMAL) - np.expm1(-u / THERMAL))
        return np.array([((w[1] - u) / z0 - diodes) / c]), np.array([data(t) - drop(t, w[0], mode[0]), x[0]])

    def edges(t, x, w, mode):
        return [table.edges(mode[0], drop(t, w[0], mode[0]))]

    t_end = 5 * NS
    return integrate(
        circuit, [Line(z0, 0.4 * NS)], t_end,
        scale=[1.0], corners=data.corners(t_end), edges=edges, mode=(1,), longest=0.005 * NS,
    )  # fmt: skip


def multi_drop_bus() -> Motion:
    """C u' = (w - u)/60 at three chips; taps are junctions."""
    pulses, t_end, c = Pulses(1.5, 0.1 * NS, 0.2 * NS, 2.8 * NS, 6 * NS), 10 * NS, np.array([2, 3, 5]) * PF
    z0, stub, damping = 50.0, 60.0, 15.0
    delays = [0.5, 0.3, 0.3, 0.2]
    lines = [Line(z0, d * NS) for d in delays] + [Line(stub, 0.1 * NS)] * 3

    def circuit(t, x, w, mode):
        u = np.empty(14)
        u[0], u[7] = behind(pulses(t), 30.0, w[0]), w[7] / 2
        for k in range(3):
            left, right, side = 2 * k + 1, 2 * k + 2, 8 + 2 * k
            g = 1 / (stub + damping)
            u[left] = u[right] = ((w[left] + w[right]) / z0 + g * w[side]) / (2 / z0 + g)
            u[side] = w[side] + stub * g * (u[left] - w[side])
            u[side + 1] = x[k]
        return (w[9::2] - x) / (stub * c), u

    return integrate(circuit, lines, t_end, scale=[1.0] * 3, corners=pulses.corners(t_end))


def ac_coupled() -> Motion:
    """C v' = i, i = (w1 - w2 - v)/(2 z0)."""
    pulses, t_end, z0, c = Pulses(0.8, 20 * NS, 20 * NS, 580 * NS, 1 * US), 3 * US, 50.0, 100e-9

    def circuit(t, x, w, mode):
        i = (w[1] - w[2] - x[0]) / (2 * z0)
        u = [behind(pulses(t), 50.0, w[0]), w[1] - z0 * i, w[2] + z0 * i, w[3] * 60 / (60 + z0)]
        return np.array([i / c]), np.array(u)

    lines = [Line(z0, 5 * NS), Line(z0, 15 * NS)]
    return integrate(circuit, lines, t_end, scale=[1.0], corners=pulses.corners(t_end))


def via_tdr() -> Motion:
    """C u1' = (w1 - u1)/z0 - i, L i' = u1 - u2, C u2' = i + (w2 - u2)/z0."""
    z0, c, inductance, begin, rise = 50.0, 0.06 * PF, 0.5e-9, 0.1 * NS, 0.035 * NS

    def circuit(t, x, w, mode):
        u1, u2, i = x
        e = 0.5 * min(max((t - begin) / rise, 0), 1)
        rates = [((w[1] - u1) / z0 - i) / c, ((w[2] - u2) / z0 + i) / c, (u1 - u2) / inductance]
        return np.array(rates), np.array([behind(e, z0, w[0]), u1, u2, w[3] / 2])

    lines = [Line(z0, 0.3 * NS)] * 2
    return integrate(circuit, lines, 1.4 * NS, scale=[1.0, 1.0, 0.02], corners=(begin, begin + rise), longest=1e-12)


def pad_6db() -> Motion:
    """Two nodes with their resistors: a matrix."""
    pulses, z0 = Pulses(2.0, 1 * NS, 0.5 * NS, 3 * NS), 50.0
    g, across = 1 / z0 + 1 / 150.5, 1 / 37.35
    solved = np.linalg.inv([[g + across, -across], [-across, g + across]]) / z0

    def circuit(t, x, w, mode):
        return NONE, np.array([behind(pulses(t), z0, w[0]), *(solved @ w[1:3]), w[3]])

    lines = [Line(z0, 3 * NS), Line(z0, 5 * NS)]
    return integrate(circuit, lines, 30 * NS, scale=[1.0], corners=pulses.corners(30 * NS))


def l_match() -> Motion:
    """L i' = w1 - 50 i - u, C u' = i + (w2 - u)/200."""
    z1, z2, inductance, c, turns = 50.0, 200.0, 176.7e-9, 17.67 * PF, 2 * np.pi * 78e6

    def circuit(t, x, w, mode):
        i, u = x
        rates = [(w[1] - z1 * i - u) / inductance, (i + (w[2] - u) / z2) / c]
        ends = [behind(2 * np.sin(turns * t), z1, w[0]), w[1] - z1 * i, u, w[3] / 2]
        return np.array(rates), np.array(ends)

    return integrate(circuit, [Line(z1, 6 * NS), Line(z2, 4 * NS)], 150 * NS, scale=[0.02, 1.0])


def double_exponential(peak: float, rise: float, decay: float) -> Callable[[float], float]:
    """A surge that reaches its peak where its slope is zero."""
    top = np.log(decay / rise) * rise * decay / (decay - rise)
    factor = peak / (np.exp(-top / decay) - np.exp(-top / rise))
    return lambda t: float(factor * (np.exp(-t / decay) - np.exp(-t / rise)))


def lightning() -> Motion:
    """C u' = (w - u)/z0 - table(u); the current at the strike goes both ways."""
    surge, z0, c = double_exponential(3e3, 0.4 * US, 68 * US), 350.0, 2e-9
    half = 1e3 * np.array([150, 200, 230, 260, 290])
    table = Table(np.concatenate([-half[::-1], half]), np.array([-1e4, -5e3, -1e3, -100, -1, 1, 100, 1e3, 5e3, 1e4]))

    def circuit(t, x, w, mode):
        g, j = table.piece(mode[0])
        strike = (w[1] + w[2] + z0 * surge(t)) / 2
        return np.array([((w[3] - x[0]) / z0 - g * x[0] - j) / c]), np.array([w[0] / 2, strike, strike, x[0]])

    def edges(t, x, w, mode):
        return [table.edges(mode[0], x[0])]

    lines = [Line(z0, 1 * US), Line(z0, 2 * US)]
    return integrate(circuit, lines, 20 * US, scale=[1e5], edges=edges, mode=(4,), longest=0.1 * US)


def balun() -> Motion:
    """L i' = u, with the matrix of two coupled coils; the second floats between two lines."""
    pulses, t_end, z0 = Pulses(2.0, 1 * NS, 1 * NS, 9 * NS, 20 * NS), 60 * NS, 50.0
    mutual = 0.99 * np.sqrt(1e-6 * 2e-6)
    inverse = np.linalg.inv([[1e-6, mutual], [mutual, 2e-6]])

    def circuit(t, x, w, mode):
        first, plus, minus = w[1] - z0 * x[0], w[2] - z0 * x[1], w[4] + z0 * x[1]
        ends = [behind(pulses(t), z0, w[0]), first, plus, w[3] / 2, minus, w[5] * 75 / (75 + z0)]
        return inverse @ [first, plus - minus], np.array(ends)

    lines = [Line(z0, 2 * NS), Line(z0, 3 * NS), Line(z0, 3 * NS)]
    return integrate(circuit, lines, t_end, scale=[0.02, 0.02], corners=pulses.corners(t_end))


ELECTRICAL = {
    "ddr_receiver": ByHand(ddr_receiver, {"pad": 0, "ball": 1}),
    "multi_drop_bus": ByHand(multi_drop_bus, {"chip1": 9, "chip3": 13, "end": 7}),
    "ac_coupled": ByHand(ac_coupled, {"before": 1, "receiver": 3}),
    "via_tdr": ByHand(via_tdr, {"instrument": 0, "end": 3}),
    "pad_6db": ByHand(pad_6db, {"generator": 0, "end": 3}),
    "l_match": ByHand(l_match, {"coil": 1, "antenna": 3}),
    "lightning": ByHand(lightning, {"strike": 2, "station": 3}),
    "balun": ByHand(balun, {"in": 1, "end_plus": 3, "end_minus": 5}),
}
