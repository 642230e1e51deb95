"""Page of a desk over HTTP: on the loopback interface alone, behind a token in the address."""

import json
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from secrets import token_urlsafe
from threading import Lock
from typing import Any

from tline.errors import InputError
from tline.live.desk import Desk

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
