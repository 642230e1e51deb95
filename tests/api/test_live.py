"""`tline live`: the page of a scene on this machine, for whoever has its address alone."""

import base64
import http.client
import json
import shutil
import subprocess
import threading

import numpy as np
import pytest
from click.testing import CliRunner

import tline as tl
from tline.cli.main import main
from tline.live.desk import MOST_SLIDERS, Desk, Server, sliders
from tline.solver.result.dense_output import curve

PIPE = Desk(tl.examples["water_pipe"], 'tl.examples["water_pipe"]')


@pytest.fixture(scope="module")
def server():
    with Server(PIPE) as running:
        threading.Thread(target=running.serve_forever, daemon=True).start()
        yield running
        running.shutdown()


def ask(server, method, page, body=None, host=None, token=None):
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    text = body if isinstance(body, str | None) else json.dumps(body)
    headers = {} if host is None else {"Host": host}
    connection.request(method, f"/{server.token if token is None else token}/{page}", text, headers)
    answer = connection.getresponse()
    found = answer.status, answer.read().decode()
    connection.close()
    return found


def told(server, page, body):
    status, text = ask(server, "POST", page, body)
    assert status == 200
    return json.loads(text)


def test_the_page_needs_nothing_from_elsewhere(server):
    status, page = ask(server, "GET", "")
    assert status == 200
    assert "<canvas" not in page.partition("<script>")[0]
    assert "http" not in page
    assert server.address == f"http://127.0.0.1:{server.server_port}/{server.token}/"


@pytest.mark.parametrize("how", [{"token": "guess"}, {"host": "evil.example"}, {"host": "localhost:1"}])
@pytest.mark.parametrize("page", ["", "first", "seen", "waves", "copied"])
def test_nobody_else_gets_anything(server, page, how):
    assert ask(server, "POST" if page else "GET", page, {} if page else None, **how) == (403, "")


def test_traces_are_those_of_a_run(server):
    moved = {"lines.pipe.wave_speed": 1200.0, "t_end": 3.0}
    seen = told(server, "seen", moved)
    own = tl.simulate(PIPE.scene.change(moved)).probes["valve"]
    pressure, flow = seen["panels"]
    assert (pressure["y"], pressure["x"], pressure["end"]) == ("pressure [bar]", "time [s]", 3.0)
    assert max(pressure["curves"]["valve"][1]) == pytest.approx(max(own.u) / 1e5, abs=1e-4)
    assert flow["curves"]["valve"][1][0] == pytest.approx(own.y[0] * 1e3, abs=1e-4)
    assert seen["now"]["lines.pipe.wave_speed"] == "1.2 km/s"
    assert "valve" in seen["text"]
    levels = np.frombuffer(base64.b64decode(seen["map"]["levels"]), np.uint8).reshape(seen["map"]["rows"], -1)
    assert (levels.min(), levels.max()) == (0, 255)
    assert (levels[0] == levels[0, 0]).all()  # steady at first


def test_a_trace_has_its_extremes_however_narrow():
    scene = tl.examples["diode_clamp"]
    own = tl.prepare(scene).run()
    for name, (t, values) in Desk(scene, "").seen({})["panels"][0]["curves"].items():
        seen = curve(own.probes[name])
        assert (min(values), max(values)) == pytest.approx((seen.u.min(), seen.u.max()), abs=1e-5)
        assert (t[0], t[-1], len(t) < 1700, (np.diff(t) >= 0).all()) == (0, 1, True, True)


def test_the_page_begins_with_the_scene_as_given(server):
    first = told(server, "first", {})
    assert first["title"] == "Water pipe, the valve shuts at 0.2 s"
    assert first["sliders"]["lines.pipe.length"] == 300
    assert first["network"].startswith("<img")
    for one, other in zip(first["panels"], told(server, "seen", {})["panels"], strict=True):  # of another order
        assert max(one["curves"]["middle"][1]) == pytest.approx(max(other["curves"]["middle"][1]), abs=1e-4)


def test_waves_travel_on_a_page_of_their_own(server):
    page = told(server, "waves", {"t_end": 1.0})["page"]
    assert '"marks":[[0.0,"reservoir"],[300.0,"valve"]]' in page
    assert Desk(tl.examples["loop"], "").waves({}) == {"page": None}


def test_copies_give_the_same_scene(server, tmp_path):
    copies = told(server, "copied", {"lines.pipe.length": 450.0})
    (tmp_path / "scene.toml").write_text(copies["toml"], encoding="utf-8")
    assert tl.read(tmp_path / "scene.toml").lines["pipe"].length == 450
    names: dict = {}
    exec(copies["python"], names)
    assert names["result"].scene.lines["pipe"].length == 450
    exec(told(server, "copied", {})["python"], names)
    assert names["result"].scene == PIPE.scene


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        ({"lines.pipe.colour": 1.0}, "lines.pipe.colour: no slider, expected a number of the scene"),
        ({"t_end": "1 s"}, "t_end: not a finite number, expected a number in SI, got '1 s'"),
        ({"t_end": True}, "t_end: not a finite number"),
        ({"lines.pipe.length": -1.0}, "lines.pipe.length: "),
        ([1], "values: not a table, or too long"),
        ("{", "Expecting property name"),
        ("[" * 100_001, "values: not a table, or too long"),
    ],
)
def test_mistakes_get_one_sentence(server, body, sentence):
    assert told(server, "seen", body)["error"].startswith(sentence)


def test_sliders_of_networks_loops_and_parts_of_files():
    assert Desk(tl.examples["loop"], "").seen({})["map"] is None
    assert len(sliders(tl.examples["town"])) <= MOST_SLIDERS
    for name in ("antenna", "coupled_pair", "filter"):
        scene = tl.examples[name]
        for path, value in sliders(scene).items():
            assert scene.change({path: float(value)}) is not None


def test_the_command_says_the_address_and_what_is_wrong(monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("tline.live.desk.IDLE", 0.0)
    shown = CliRunner().invoke(main, ["live", "water_pipe"], catch_exceptions=False).output
    assert shown == f"{opened[0]}  (Ctrl-C ends it)\n"
    assert CliRunner().invoke(main, ["live", "water_pipe", "--no-browser"]).exit_code == 0
    assert len(opened) == 1
    assert CliRunner().invoke(main, ["live", "nothing.toml"]).stderr.startswith("nothing.toml: cannot be read")


@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs a browser")
def test_a_browser_shows_it(server, tmp_path):
    options = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        f"--user-data-dir={tmp_path}",
        "--virtual-time-budget=8000",
    ]
    done = subprocess.run(["chromium", *options, "--dump-dom", server.address], capture_output=True, text=True)
    assert done.stdout.count("<canvas") == 3
    assert 'name="lines.pipe.length">300 m</output>' in done.stdout
    assert "15.3 bar … 44.7 bar" in done.stdout
