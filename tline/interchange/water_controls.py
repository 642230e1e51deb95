"""Controls and rules of water networks: links to open or shut at an instant, or once a pressure is reached."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

MOST_SHOWN = 80  # characters of a control


@dataclass(frozen=True)
class WaterControl:
    """A control, or a rule with a single premise."""

    text: str  # as the file has it, or the name of the rule
    link: str = ""  # that it acts on; empty where it does not reduce to an action and an instant or a level
    opens: bool | None = None  # whether it opens or shuts that; None where it sets something else
    after: float | None = None  # when it acts, from the operating point on, s; None if it waits for a level
    node: str = ""  # where it waits for a pressure, which may be a tank's level
    above: bool = False  # whether the pressure there is to exceed the one that follows, or to fall below it
    pressure: float = 0.0  # gauge pressure, Pa


def water_controls(
    answer: Mapping[str, Any],
    lines: Sequence[Sequence[str]],
    nodes: Mapping[str, Any],
    scale: float,
    length: float,
    weight: float,
) -> tuple[WaterControl, ...]:
    """Controls, then rules, in the order of the file; without those whose instant is past.

    Of a metre of liquid `scale` is the pressure in the unit of the file, `weight` that in Pa; `length` is the file's
    unit, m. EPANET's answer does not tell ``OPEN`` from a setting of 1: words of the lines do.
    """

    def begin(when: Mapping[str, Any]) -> dict[str, Any]:
        if "after" in when:
            return {"after": when["after"]}
        node = nodes[when["node"]]
        what = when["what"] or ("level" if node["type"] else "pressure")
        level = when["value"] / scale if what == "pressure" else when["value"] * length
        level -= node["elevation"] if what == "head" else 0.0
        return {"node": when["node"], "above": when["above"], "pressure": level * weight}

    found = [
        WaterControl(" ".join(words)[:MOST_SHOWN], told["link"], _opens(words[2]), **begin(told))
        for told, words in zip(answer["controls"], lines, strict=True)
        if told["link"]
    ]
    for rule in answer["rules"]:
        text = f"rule {rule['name']}"
        each = [WaterControl(text, link, _opens(state), **begin(rule["when"])) for link, state in rule["actions"]]
        found += each or [WaterControl(text)]
    return tuple(control for control in found if control.after is None or control.after > 0)


def _opens(state: str) -> bool | None:
    """Whether a word opens or shuts a link in EPANET, by its first letters; None for other words."""
    state = state.upper()
    return True if state.startswith("OPEN") else False if state.startswith("CLOS") else None
