"""The report of a study as a self-contained page: table, worst nodes, maps and profiles; it prints well."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tline.pictures.bounds import one_liquid, scale
from tline.pictures.map import Surge, draw_surges
from tline.pictures.page import drawn, page, table
from tline.pictures.path import axis, route
from tline.scene.heights import weight_at
from tline.style import COLOURS, DASHES, INK, figure, name_nodes, styled
from tline.surge.scenarios import AS_READ

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tline.surge.study import Outcome, SurgeStudy

WORST = 10  # nodes in tables
Nodes = Mapping[str, Mapping[str, Any]]  # extremes of each in the scenario that was worst for it, with its name


def study_page(study: "SurgeStudy") -> str:
    """Return the page as HTML."""
    return page(study.plan.title or "A study of surges", _parts(study))


def _parts(study: "SurgeStudy") -> Iterator[str]:
    head, rows = study.table()
    yield f"<p>{escape([*study.text_lines()][1])}.</p>"
    if len(study.plan.variants) > 1:
        yield "<h2>Variants</h2>" + _comparison(study)
    for variant in study.plan.variants:
        found = _of_variant(study, variant)
        if found:
            yield f"<h2>The network {'' if variant == AS_READ else 'with '}{escape(variant)}</h2>"
            yield _worst_nodes(study, found)
            yield drawn(worst_map, study, variant)
            for path in study.plan.paths:
                yield drawn(worst_profile, study, variant, path)
    marks = ["" if outcome.signed else ' class="no"' for outcome in study.outcomes]
    yield "<h2>Scenarios</h2>" + table(head, rows, marks)
    yield "<h2>To run them again</h2><p>Each scenario is a scene in the study's folder, which "
    yield "<code>tline run FILE --envelope nodes.csv</code> runs just so:</p><ul>"
    yield from (
        f"<li>{escape(each.scenario.name)}: <code>{each.scenario.file}.toml</code></li>" for each in study.outcomes
    )
    notes = dict.fromkeys(note for outcome in study.outcomes for note in outcome.told.get("notes", ()))
    yield "</ul><h2>Notes</h2><ul>" + "".join(f"<li>{escape(note)}</li>" for note in notes) + "</ul>"


def _comparison(study: "SurgeStudy") -> str:
    """Largest rise and fall of pressures in each event, variants side by side."""
    rows: dict[str, dict[str, str]] = {}
    for outcome in study.outcomes:
        told = outcome.scenario
        cell = " / ".join(study.moved(outcome, "rise", "fall")) or "failed"
        rows.setdefault(f"{told.event} {told.element}".rstrip(), {})[told.variant] = cell
    names = [*study.plan.variants]
    return table(
        [f"rise / fall [{study.unit[1]}]", *names],
        [[event, *(row.get(name, "") for name in names)] for event, row in rows.items()],
    )


def _worst_nodes(study: "SurgeStudy", found: Sequence["Outcome"]) -> str:
    size, unit = study.unit
    parts = []
    for word, sign in (("highest", 1), ("lowest", -1)):
        nodes = _of_nodes(found, word, sign)
        worst = sorted(nodes.values(), key=lambda node: -sign * node[word])[:WORST]
        rows = [
            [
                node["node"],
                f"{node['before'] / size:.4g}",
                f"{node[word] / size:.4g}",
                f"{node[f'{word}_at']:.4g}",
                node["in"],
            ]
            for node in worst
        ]
        parts.append(table([f"{word} pressures", f"before [{unit}]", f"{word} [{unit}]", "after [s]", "in"], rows))
    return f'<div class="two">{"".join(parts)}</div>'


def _of_nodes(found: Sequence["Outcome"], word: str, sign: int) -> dict[str, dict[str, Any]]:
    """Extremes of each node in the scenario that was worst for it."""
    worst: dict[str, dict[str, Any]] = {}
    for outcome in found:
        for node in outcome.told["nodes"]:
            name = node["node"]
            if name not in worst or sign * (node[word] - worst[name][word]) > 0:
                worst[name] = {**node, "in": outcome.scenario.name}
    return worst


def _of_variant(study: "SurgeStudy", variant: str) -> list["Outcome"]:
    return [outcome for outcome in study.outcomes if outcome.scenario.variant == variant and outcome.worst]


def worst_map(study: "SurgeStudy", variant: str, ax: "Axes | None" = None) -> "Figure | Axes":
    """Maps of how far the pressure rose, and fell, in any scenario of a variant; on `ax` of how far it rose."""
    found, scene = _of_variant(study, variant), study.plan.variants[variant].scene
    there = {node for line in scene.lines.values() for node in line.nodes}
    both = []
    for word, sign in (("highest", 1), ("lowest", -1)):
        nodes = _of_nodes(found, word, sign)
        moves = {name: max(sign * (node[word] - node["before"]), 0.0) for name, node in nodes.items() if name in there}
        both.append(Surge(moves, {}, {}))
    return draw_surges(scene, *both, ax=ax)


@styled
def worst_profile(study: "SurgeStudy", variant: str, path: Sequence[str]) -> "Figure":
    """Heads at the nodes along a path: the steady one, the extremes of every scenario, and those of all."""
    found, scene = _of_variant(study, variant), study.plan.variants[variant].scene
    way = route(scene, *path)
    weight = weight_at(scene)
    ground = np.array([weight.get(node, 0.0) for node in way.nodes])

    def along(outcome: "Outcome", word: str) -> NDArray:
        nodes = {node["node"]: node[word] for node in outcome.told["nodes"]}
        return np.array([nodes.get(node, np.nan) for node in way.nodes]) + ground

    highest, lowest = (np.array([along(outcome, word) for outcome in found]) for word in ("highest", "lowest"))
    word, size, unit = scale(scene, way.lines, float(np.nanmax(np.abs(highest))))
    metre, place = axis(way, scene)
    x = np.array(way.marks) / metre
    picture = figure(8.0, 4.6, "")
    axes = picture.subplots()
    axes.plot(x, highest.T / size, color=COLOURS[1], alpha=0.25, linewidth=0.8)
    axes.plot(x, lowest.T / size, color=COLOURS[0], alpha=0.25, linewidth=0.8)
    axes.plot(x, np.nanmax(highest, axis=0) / size, color=COLOURS[1], label="highest of all scenarios")
    axes.plot(x, along(found[0], "before") / size, color=INK, linestyle=DASHES[1], label="steady")
    axes.plot(x, np.nanmin(lowest, axis=0) / size, color=COLOURS[0], label="lowest of all scenarios")
    if one_liquid(scene, way.lines) is not None:
        axes.plot(x, ground / size, color="#7A6A53", linewidth=1.4, label="ground")
    axes.set(xlim=(x[0], x[-1]), xlabel=place, ylabel=f"{word} [{unit}]")
    axes.grid(True, axis="y")
    name_nodes(axes, {mark / metre: name for mark, name in way.labels.items()})
    picture.legend(loc="outside lower center", ncols=4)
    return picture
