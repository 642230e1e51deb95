"""Pictures: what they show is what was computed, every axis says its unit, and nothing else is touched."""

import json
import re
import sys
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from picture_scenes import FORK, JOUKOWSKY, TANK, cables, quietly, water_hammer
from PIL import Image

from tline import InputError, MissingExtraError, Result, plot
from tline.pictures import Route, plot_lattice, plot_space_time, route, save_figure
from tline.pictures.animation import FRAMES, PLACES, STEPS, animated
from tline.pictures.path import effort_along
from tline.units import handy


@pytest.fixture(scope="module")
def surge() -> Result:
    return quietly(water_hammer())


@pytest.fixture(scope="module")
def fork() -> tuple[Result, Route]:
    scene = cables(FORK)
    way = route(scene, "in", "down")
    return quietly(scene, way), way


# units


@pytest.mark.parametrize(
    ("largest", "unit", "expected"),
    [
        (0.0042, "A", (1e-3, "mA")),
        (7e5, "bar", (1e5, "bar")),
        (0.01, "L/s", (1e-3, "L/s")),
        (1e4, "V", (1e3, "kV")),
        (2e-6, "s", (1e-6, "µs")),
        (7200.0, "s", (1.0, "s")),
        (0.0, "V", (1.0, "V")),
    ],
)
def test_handy_units(largest: float, unit: str, expected: tuple[float, str]) -> None:
    assert handy(largest, unit) == (pytest.approx(expected[0]), expected[1])


# routes


def test_a_chain_is_found_whole_whichever_way_its_lines_run() -> None:
    way = route(cables({"one": ("a", "b", "1 ns"), "two": ("c", "b", "2 ns"), "three": ("c", "d", "3 ns")}))
    assert way.nodes == ("a", "b", "c", "d")
    assert [(leg.line, leg.forward) for leg in way.legs] == [("one", True), ("two", False), ("three", True)]
    assert [leg.start for leg in way.legs] == pytest.approx([0, 1e-9, 3e-9])
    assert way.unit == "s"
    assert way.marks == pytest.approx((0, 1e-9, 3e-9, 6e-9))
    assert route(water_hammer())[2:] == ((0.0, 300.0), "m")


def test_the_way_of_least_delay_is_taken() -> None:
    ring = cables(
        {"ab": ("a", "b", "5 ns"), "bc": ("b", "c", "1 ns"), "ac": ("c", "a", "3 ns"), "twin": ("a", "b", "6 ns")}
    )
    assert route(ring, "a", "b").lines == ("ac", "bc")
    assert [leg.forward for leg in route(ring, "a", "b").legs] == [False, False]
    assert route(ring, "a", "c").lines == ("ac",)


@pytest.mark.parametrize(
    ("lines", "nodes", "problem"),
    [
        (FORK, (), "path: the lines form no chain, expected the two nodes between which to look"),
        (FORK, (("a", "b"),), "path: is no name, expected each node as an argument of its own, got ('a', 'b')"),
        ({"a": ("p", "q", "1 ns"), "b": ("r", "s", "1 ns")}, (), "path: the lines form no chain"),
        ({"a": ("p", "q", "1 ns"), "b": ("q", "p", "1 ns")}, (), "path: the lines form no chain"),
        (
            {"a": ("p", "q", "1 ns"), "b": ("r", "r", "1 ns")},
            (),
            "path: the lines form no chain, for one has both ends at node 'r', expected the two nodes between which",
        ),
        (
            {"a": ("p", "p", "1 ns")},
            (),
            "path: the lines form no chain, for one has both ends at node 'p', expected a scene with two nodes or more",
        ),
        (FORK, ("in", "donw"), "path: no such node, expected 'down', got 'donw'"),
        (FORK, ("in", "in"), "path: leads nowhere, expected two different nodes, got 'in' twice"),
        ({"a": ("p", "q", "1 ns"), "b": ("r", "s", "1 ns")}, ("p", "s"), "path: no lines lead there, got 'p' and 's'"),
    ],
)
def test_routes_that_are_none(lines: dict, nodes: tuple[str, ...], problem: str) -> None:
    with pytest.raises(InputError, match=re.escape(problem)):
        route(cables(lines), *nodes)


def test_effort_along_a_route_agrees_with_probes(fork: tuple[Result, Route]) -> None:
    _, way = fork
    scene = cables(
        FORK,
        probes={
            "in": {"at": "in"},
            "half": {"line": "stem", "position": "50 %"},
            "third": {"line": "right", "position": "1 %"},
            "down": {"at": "down"},
        },
    )
    result = quietly(scene, way)
    t = np.linspace(0, 50e-9, 300)
    effort = effort_along(result, way, np.array([0.0, 2e-9, 4e-9 + 0.99 * 6e-9, 10e-9]), t)
    for column, name in zip(effort.T, ("in", "half", "third", "down"), strict=True):
        np.testing.assert_allclose(column, result.probes[name].at(t).u, atol=1e-9)  # 1e-9: jumps read at t ± rounding


def test_a_line_that_was_not_recorded_is_named() -> None:
    scene = cables(FORK)
    with pytest.raises(InputError, match="path: line 'right' was not recorded, expected simulate"):
        plot_space_time(quietly(scene), route(scene, "in", "down"))


# probes over time


def test_traces_show_the_water_hammer(surge: Result) -> None:
    picture = plot(surge)
    above, below = picture.axes
    assert (above.get_ylabel(), below.get_ylabel(), below.get_xlabel()) == ("pressure [bar]", "flow [L/s]", "time [s]")
    assert picture.get_suptitle() == "Closing valve"
    t, pressure = np.asarray(above.lines[0].get_data())
    jump = np.abs(t - 0.1) < 1e-12
    np.testing.assert_allclose(pressure[jump], [6.0, 6.0 + JOUKOWSKY / 1e5])  # vertical
    assert pressure.max() == pytest.approx(6.0 + JOUKOWSKY / 1e5)
    assert np.asarray(below.lines[0].get_data())[1].max() == pytest.approx(10.0)  # litres a second
    legend = picture.legends[0]
    assert [text.get_text().strip() for text in legend.get_texts()] == ["valve", "_middle"]


def test_one_probe_needs_no_legend() -> None:
    picture = plot(quietly(water_hammer(probes={"valve": {"at": "valve"}})))
    assert picture.legends == []
    assert picture.axes[0].get_ylabel() == "pressure at valve [bar]"


def test_small_electrical_values_get_prefixes() -> None:
    above, below = plot(quietly(cables({"c": ("near", "far", "5 ns")}))).axes
    assert (above.get_ylabel(), below.get_ylabel()) == ("voltage at in [V]", "current at in [mA]")
    assert below.get_xlabel() == "time [ns]"
    assert above.get_xlim() == pytest.approx((0, 50))


def test_curves_differ_in_more_than_colour(surge: Result) -> None:
    lines = plot(surge).axes[0].lines
    assert len({line.get_linestyle() for line in lines}) == len({line.get_color() for line in lines}) == 2


# space and time


def test_space_time_is_the_effort_over_metres_and_seconds(surge: Result) -> None:
    way = route(surge.scene)
    picture = plot_space_time(surge, way)
    axes, bar = picture.axes[0], picture.axes[-1]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("distance from tank [m]", "time [s]")
    assert bar.get_ylabel() == "pressure [bar]"
    image = axes.images[0]
    assert image.get_extent() == pytest.approx([0, 300, 2, 0])
    effort = np.asarray(image.get_array())
    down, across = effort.shape
    t, x = (np.arange(down) + 0.5) / down * 2.0, (np.arange(across) + 0.5) / across * 300
    late = (t[:, None] - 0.1) % 0.8 > (300 - x) / 1500  # the first front has passed, and then every 4 T
    back = (t[:, None] - 0.1) % 0.8 > 0.4 - (300 - x) / 1500
    again = (t[:, None] - 0.1) % 0.8 > 0.4 + (300 - x) / 1500
    last = (t[:, None] - 0.1) % 0.8 > 0.8 - (300 - x) / 1500
    expected = 6 + JOUKOWSKY / 1e5 * (late * 1.0 - back - again + last) * (t[:, None] > 0.1)
    assert (np.abs(effort - expected) > 1e-6).mean() < 1e-4  # but for pixels that rounding puts on the other side
    names = [label.get_text() for label in axes.child_axes[0].get_xticklabels()]
    assert names == ["tank", "valve"]


def test_space_time_parts_its_colours_at_the_start_if_there_is_something_on_both_sides(surge: Result) -> None:
    norm = plot_space_time(surge, route(surge.scene)).axes[0].images[0].norm
    assert norm.vmin is not None
    assert norm.vmax is not None
    assert np.mean([norm.vmin, norm.vmax]) == pytest.approx(TANK / 1e5)
    scene = cables({"c": ("near", "far", "5 ns")}, loads={"end": {"at": "far", "kind": "resistor", "resistance": 200}})
    image = plot_space_time(quietly(scene), route(scene)).axes[0].images[0]
    assert image.norm.vmin == pytest.approx(0.0)
    assert image.get_cmap().name == "viridis"


def test_space_time_of_a_route_without_lengths(fork: tuple[Result, Route]) -> None:
    result, way = fork
    axes = plot_space_time(result, way).axes[0]
    assert axes.get_xlabel() == "delay from in [ns]"
    assert axes.images[0].get_extent() == pytest.approx([0, 10, 50, 0])
    assert [label.get_text() for label in axes.child_axes[0].get_xticklabels()] == ["in", "fork", "down"]


# bounce diagram


def test_lattice_shows_one_line_only(fork: tuple[Result, Route]) -> None:
    with pytest.raises(
        InputError, match="lattice: a bounce diagram shows one line, expected a scene with one line, got 3"
    ):
        plot_lattice(fork[0])


# animation


def data_of(page: str) -> dict[str, Any]:
    found = re.search(r"^const data = (.*);$", page, re.MULTILINE)
    assert found
    return json.loads(found[1])


def test_page_needs_nothing_else_and_holds_the_efforts(surge: Result, tmp_path: Path) -> None:
    way = route(surge.scene)
    animated(surge, way).save(tmp_path / "surge.html")
    page = (tmp_path / "surge.html").read_text(encoding="utf-8")
    assert len(page) < 1_000_000
    assert not re.search(r"https?:|src=|@import|url\(|\blink\b", page)
    data = data_of(page)
    low, high = data["range"]
    assert (low, high) == pytest.approx(((TANK - JOUKOWSKY) / 1e5, (TANK + JOUKOWSKY) / 1e5))
    frames = low + np.array(data["frames"]) / data["steps"] * (high - low)
    assert frames.shape == (FRAMES, PLACES)
    t = np.arange(FRAMES) * data["step"]
    assert t[-1] == pytest.approx(2.0)
    expected = effort_along(surge, way, np.linspace(0, 300, PLACES), t) / 1e5
    np.testing.assert_allclose(frames, expected, atol=0.5001 * (high - low) / STEPS)  # rounded to a step
    low, high = data["wave_range"]
    along = low + np.array(data["along"]) / data["steps"] * (high - low)
    right = np.array([surge.lines["pipe"].waves(t, x)[0] for x in np.linspace(0, 1, PLACES)]).T / 2e5  # a by its line
    np.testing.assert_allclose(along, right, atol=0.5001 * (high - low) / STEPS)
    assert np.all(np.array(data["lowest"]) <= data["frames"])
    assert np.all(np.array(data["highest"]) >= data["frames"])
    assert (data["effort"], data["place"], data["time"]) == ("pressure [bar]", "distance from tank [m]", "s")
    assert data["marks"] == [[0.0, "tank"], [300.0, "valve"]]


def test_names_cannot_break_out_of_the_page(tmp_path: Path) -> None:
    title = "</script><b>DATA & TITLE"
    scene = cables({"c": ("near", "<far>", "5 ns")}, title=title)
    animated(quietly(scene), route(scene)).save(tmp_path / "x.html")
    page = (tmp_path / "x.html").read_text(encoding="utf-8")
    assert page.count("</script>") == 1
    assert "<title>&lt;/script&gt;&lt;b&gt;DATA &amp; TITLE</title>" in page
    data = data_of(page)
    assert data["title"] == title
    assert data["marks"][1][1] == "<far>"


@pytest.fixture
def few_frames(monkeypatch: pytest.MonkeyPatch) -> int:
    """Instead of 180, each of which is drawn."""
    monkeypatch.setattr("tline.pictures.animation.FRAMES", 9)
    return 9


def test_gif_plays_all_frames(surge: Result, few_frames: int, tmp_path: Path) -> None:
    animated(surge, route(surge.scene)).save(tmp_path / "surge.gif")
    with Image.open(tmp_path / "surge.gif") as movie:
        assert getattr(movie, "n_frames", 1) == few_frames
        assert movie.info["loop"] == 0
        first = np.asarray(movie.convert("RGB"))
        movie.seek(few_frames // 2)
        assert np.any(np.asarray(movie.convert("RGB")) != first)


def test_unknown_animations_are_refused(surge: Result, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"unknown kind of animation, expected \.html or \.gif or \.mp4, got '\.mov'"):
        animated(surge, route(surge.scene)).save(tmp_path / "surge.mov")
    assert list(tmp_path.iterdir()) == []


def test_a_film_has_all_frames_and_the_size_of_the_picture(surge: Result, few_frames: int, tmp_path: Path) -> None:
    import imageio_ffmpeg

    animated(surge, route(surge.scene)).save(tmp_path / "surge.mp4")
    film = imageio_ffmpeg.read_frames(str(tmp_path / "surge.mp4"))
    assert next(film)["size"] == (800, 420)
    assert imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "surge.mp4"))[0] == few_frames
    film.close()


def test_without_ffmpeg_a_film_is_refused_in_a_sentence(
    surge: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingExtraError, match=r"\.mp4: ffmpeg is missing"):
        animated(surge, route(surge.scene)).save(tmp_path / "surge.mp4")
    assert list(tmp_path.iterdir()) == []


# files, and the user's settings


@pytest.mark.parametrize(("suffix", "begins"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")])
def test_figures_become_files_that_do_not_depend_on_the_day(
    suffix: str, begins: bytes, surge: Result, tmp_path: Path
) -> None:
    for name in ("one", "two"):
        save_figure(plot(surge), tmp_path / f"{name}{suffix}")
    one = (tmp_path / f"one{suffix}").read_bytes()
    assert one.startswith(begins)
    assert one == (tmp_path / f"two{suffix}").read_bytes()


def test_a_figure_that_cannot_be_written_leaves_nothing(surge: Result, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written, got no such file or directory"):
        save_figure(plot(surge), tmp_path / "none" / "x.png")
    assert list(tmp_path.iterdir()) == []


def test_settings_of_the_user_stay_as_they_are(surge: Result, tmp_path: Path) -> None:
    with matplotlib.rc_context({"font.size": 17.0}):
        before = dict(matplotlib.rcParams)
        save_figure(plot_lattice(surge), tmp_path / "x.png")
        assert plot(surge).axes[0].yaxis.label.get_fontsize() == 10
        assert dict(matplotlib.rcParams) == before


def test_a_scene_in_which_nothing_happens_can_be_drawn(tmp_path: Path) -> None:
    scene = cables({"c": ("near", "far", "5 ns")}, sources={})
    result = quietly(scene)
    for picture in (plot(result), plot_lattice(result), plot_space_time(result, route(scene))):
        save_figure(picture, tmp_path / "x.png")
    animated(result, route(scene)).save(tmp_path / "x.html")
    assert len(data_of((tmp_path / "x.html").read_text(encoding="utf-8"))["frames"]) == FRAMES
