"""Prepared scene with variable numbers: its sliders, and its page, on the loopback interface behind a token."""

import json
import math
import warnings
from base64 import b64encode
from collections.abc import Iterator, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from secrets import token_urlsafe
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.pictures.animation import animated
from tline.pictures.bounds import scale, spread
from tline.pictures.path import Route, axis, effort_along, route
from tline.scene.quantity import Quantity
from tline.scene.scene import Scene
from tline.solver.prepared import prepare
from tline.solver.result.dense_output import curve
from tline.solver.result.quantities import in_tables
from tline.solver.result.result import Result
from tline.solver.simulate import UnresolvedWarning
from tline.units import engineering, handy
from tline.words.wording import place

SECTIONS, MOST_SLIDERS, MOST_PROBES = ("lines", "sources", "loads", "links"), 60, 6
INSTANTS, PLACES, ROWS, LEVELS = 800, 72, 150, 255  # of a trace, and of the picture over place and time


def sliders(scene: Scene) -> dict[str, Quantity]:
    """End of the run, and all numbers of lines, sources, loads and links that are neither 0 nor infinite.

    Examples
    --------
    >>> import tline as tl
    >>> [*sliders(tl.examples["cable_rc"])][:3]
    ['t_end', 'lines.cable.z0', 'lines.cable.delay']
    """
    found = [("t_end", scene.t_end)]
    for section in SECTIONS:
        for name, element in getattr(scene, section).items():
            if (section, name) not in scene.parts:
                found += _inside(place(section, name), element.table(), element)
    return dict(found[:MOST_SLIDERS])


def _inside(path: str, table: Mapping[str, Any], found: Any) -> Iterator[tuple[str, Quantity]]:
    for key, typed in table.items():
        at = f"{path}.{place(key)}"
        inner = found.get(key) if isinstance(found, Mapping) else getattr(found, key, getattr(found, f"{key}_", None))
        if isinstance(typed, Mapping):
            yield from _inside(at, typed, inner)
        elif isinstance(inner, Quantity) and math.isfinite(inner) and inner:
            yield at, inner


def _thinned(t: NDArray, values: NDArray) -> list[NDArray]:
    """Lowest and highest of all points that fall on one place of the screen."""
    place = (t * INSTANTS).astype(int)
    order = np.lexsort((values, place))
    ends = np.flatnonzero(np.diff(place[order], prepend=-1, append=INSTANTS + 1))
    kept = np.unique([order[ends[:-1]], order[ends[1:] - 1]])
    return [np.round(t[kept], 5), np.round(values[kept], 5)]


class Desk:
    """Scene and contents of its page; raises `InputError` for invalid numbers."""

    def __init__(self, scene: Scene, source: str):  # how Python reads it, such as tl.read("cable.toml")
        self.scene, self.source, self.prepared, self.sliders = scene, source, prepare(scene), sliders(scene)
        try:
            self.way: Route | None = route(scene)
        except InputError:  # no chain, which has no picture over place and time
            self.way = None
        lines = self.way.lines if self.way else ()
        self.record = [*{*lines} - {*self.prepared.description.probed}]  # lines with probes are recorded anyway

    def first(self) -> dict[str, Any]:
        """Initial contents of the page: title, sliders, drawing of the network, and the run as it was given."""
        network = self.scene._repr_html_().partition("<pre>")[0]  # none of too many nodes
        told = {"title": self.scene.title or "scene", "sliders": self.sliders, "network": network}
        return told | self.seen({})

    def _checked(self, values: Mapping[str, Any]) -> dict[str, float]:
        for path, value in values.items():
            if path not in self.sliders:
                raise InputError(str(path)[:60], "no slider", "a number of the scene")
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise InputError(path, "not a finite number", "a number in SI", repr(value)[:30])
        return dict(values)

    def seen(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Traces, extremes and picture over place and time of a run with these values, in SI by path."""
        result = self._run(values)
        now = {path: engineering(values.get(path, each), each.unit or "") for path, each in self.sliders.items()}
        told = {"now": now, "text": str(result).partition("\n")[2].rstrip(">")}
        return told | {"panels": self._panels(result), "map": self._map(result)}

    def waves(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Page with the waves of a run along the chain of lines; None without a chain."""
        return {"page": animated(self._run(values), self.way).html if self.way else None}

    def _run(self, values: Mapping[str, Any]) -> Result:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnresolvedWarning)  # the text reports them
            return self.prepared.run(self._checked(values), record=self.record)

    def _panels(self, result: Result) -> list[dict[str, Any]]:
        end, panels = float(result.t[-1]), []
        second, time_unit = handy(end, "s")
        samples = {name: curve(result.probes[name]) for name in [*result.probes][:MOST_PROBES]}
        for each in in_tables(result.scene):
            values = {name: each.of(seen) for name, seen in samples.items() if each.seen_by(result.probes[name])}
            if values:
                size, unit = handy(max(float(np.abs(one).max()) for one in values.values()), each.shown(self.scene))
                panel = {"y": f"{each.named(self.scene)} [{unit}]", "x": f"time [{time_unit}]", "end": end / second}
                curves = {name: _thinned(samples[name].t / end, one / size) for name, one in values.items()}
                panels.append(panel | {"curves": curves})
        return panels

    def _map(self, result: Result) -> dict[str, Any] | None:
        """Effort along the chain, as bytes in base 64, row by row from t = 0 on."""
        if self.way is None:
            return None
        x, t = np.linspace(0.0, self.way.marks[-1], PLACES), np.linspace(0.0, result.t[-1], ROWS)
        effort = effort_along(result, self.way, x, t)
        low, high = spread(float(effort.min()), float(effort.max()))
        word, size, unit = scale(result.scene, self.way.lines, max(abs(low), abs(high)))
        told = f"{word} {low / size:.4g} {unit} (blue) … {high / size:.4g} {unit} (red)"
        metre, label = axis(self.way, result.scene)
        levels = b64encode(np.rint((effort - low) / (high - low) * LEVELS).astype(np.uint8).tobytes()).decode()
        return {"levels": levels, "rows": ROWS, "told": told, "place": label, "end": self.way.marks[-1] / metre}

    def copied(self, values: Mapping[str, Any]) -> dict[str, str]:
        """Export the scene with these values as a file, and as Python."""
        moved = self._checked(values)
        given = ",\n".join(f"    {json.dumps(path)}: {value!r}" for path, value in moved.items())
        run = f"tl.prepare(scene).run({{\n{given},\n}})" if moved else "tl.simulate(scene)"
        code = f"import tline as tl\n\nscene = {self.source}\nresult = {run}\nresult.plot()\n"
        return {"toml": self.scene.change(moved).to_toml(), "python": code}


LONGEST, IDLE = 100_000, 3600.0  # bytes of a question, and seconds without one after which a server ends


class Server(ThreadingHTTPServer):
    """Server of one desk at a free port; `address` is the one to open: others than its token and host are refused."""

    daemon_threads = True

    def __init__(self, desk: Desk):
        super().__init__(("127.0.0.1", 0), _Handler)
        self.own, self.token, self.busy = f"127.0.0.1:{self.server_port}", token_urlsafe(16), Lock()
        self.address = f"http://{self.own}/{self.token}/"
        self.ended = False
        self.answers = {"first": lambda _: desk.first(), "seen": desk.seen, "waves": desk.waves, "copied": desk.copied}

    def serve(self) -> None:
        """Answer requests until a long time passes without any."""
        self.timeout = IDLE
        while not self.ended:
            self.handle_request()

    def handle_timeout(self) -> None:
        """End the server after a time without requests."""
        self.ended = True


class _Handler(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        """Send the page."""
        if self._may([""]):
            self._say(200, "text/html; charset=utf-8", files("tline.live").joinpath("page.html").read_bytes())

    def do_POST(self) -> None:
        """Send the contents of the page for some values, or the scene with these."""
        answers, length = vars(self.server)["answers"], self.headers.get("Content-Length", "")
        if not self._may(answers):
            return
        try:
            values = json.loads(self.rfile.read(int(length))) if length.isdecimal() and int(length) <= LONGEST else None
            if not isinstance(values, dict):
                raise InputError("values", "not a table, or too long", f"numbers by path, at most {LONGEST:,} bytes")
            with vars(self.server)["busy"]:
                told = answers[self.path.rpartition("/")[2]](values)
        except (InputError, ValueError) as error:
            told = {"error": str(error)}
        self._say(200, "application/json", json.dumps(told, default=lambda array: array.tolist()).encode())

    def _may(self, pages: Any) -> bool:
        own, token = (vars(self.server)[name] for name in ("own", "token"))
        allowed = self.headers.get("Host") == own and self.path in {f"/{token}/{page}" for page in pages}
        if not allowed:
            self._say(403, "text/plain", b"")
        return allowed

    def _say(self, status: int, kind: str, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing, as the page shows all."""
