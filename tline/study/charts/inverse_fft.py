"""Line in scikit-rf: cascaded two-ports, and the inverse FFT of their response to the source's spectrum."""

import time
from importlib.util import find_spec
from typing import Any

import numpy as np

from tline.scene.rational import RationalImpedance
from tline.scene.scene import Scene
from tline.study.charts.measure import TimedRun

DAMPING = 12.0  # nepers over the window: aliasing in time is damped by e^-12
REFERENCE = 50.0  # ohm, of its two-ports
WINDOW = 2.0  # of the run


def incompatibility(scene: Scene) -> str | None:
    """Reason why scikit-rf is not applicable to a scene; None if it is."""
    if find_spec("skrf") is None:
        return "not installed: pip install 'tline[peers]'"
    if scene.medium != "electrical" or any(len(each) != 1 for each in (scene.lines, scene.sources, scene.loads)):
        return "adapted to one line between a source and a load"
    line, source, load = _parts(scene)
    if not (
        source.is_effort
        and source.resistance
        and isinstance(load, RationalImpedance)
        and line.nodes == (source.at, load.at)
    ):
        return "adapted to one line between a voltage and a load of R, L and C"
    return None


def run(scene: Scene, n: int) -> TimedRun:
    """Invert u = E(s) times 1/A of the chain matrix, on a line of s right of the axis, so that nothing wraps round."""
    import skrf

    line, source, load = _parts(scene)
    dt = line.parameters.delay / n
    count = round(WINDOW * scene.t_end / dt)
    t, damping = np.arange(count) * dt, DAMPING / (WINDOW * scene.t_end)
    f = skrf.Frequency.from_f(np.fft.rfftfreq(count, dt), unit="Hz")
    begun = time.process_time()
    s = damping + 1j * f.w
    medium: Any = skrf.media.DefinedGammaZ0(f, z0=line.parameters.z0, gamma=s * line.parameters.delay)
    p, q = (np.polyval(np.array(side, float), s) for side in (load.rational().numerator, load.rational().denominator))
    chain = (
        _two_port(f, b=float(source.resistance or 0))
        ** medium.line(1.0, unit="m", z0=REFERENCE)
        ** _two_port(f, c=q / p)
    )
    drive = source.value.value(t, t + 1e-9 * dt) * np.exp(-damping * t)
    u = np.fft.irfft(np.fft.rfft(drive) / chain.a[:, 0, 0], count) * np.exp(damping * t)
    seconds = time.process_time() - begun
    return TimedRun(t, {str(name): u for name in scene.probes}, seconds, seconds)


def _parts(scene: Scene) -> list[Any]:
    return [next(iter(each.values())) for each in (scene.lines, scene.sources, scene.loads)]


def _two_port(f: Any, b: Any = 0.0, c: Any = 0.0) -> Any:
    """Two-port of a series impedance b or a shunt admittance c."""
    import skrf
    from skrf.network import a2s

    a = np.zeros((len(f), 2, 2), complex)
    a[:, 0, 0] = a[:, 1, 1] = 1.0
    a[:, 0, 1], a[:, 1, 0] = b, c
    return skrf.Network(frequency=f, s=a2s(a), z0=REFERENCE)
