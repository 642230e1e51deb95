"""What `tline run` prints of a result."""

from typing import Any

from tline.pictures.handy import handy, quantities
from tline.solver.curve import curve, extreme
from tline.solver.result import Result


def summary(result: Result) -> dict[str, Any]:
    """Resolution, and smallest, largest and last value of every probe, in SI."""
    probes: dict[str, Any] = {}
    for name, probe in result.probes.items():
        seen = curve(probe)
        probes[name] = {}
        for word, letter, unit, _ in quantities(result.medium):
            values = getattr(seen, letter)
            low, high = extreme(values, seen.t, -1), extreme(values, seen.t, 1)
            probes[name][word] = {
                "unit": unit,
                "minimum": low[0],
                "minimum_time": low[1],
                "maximum": high[0],
                "maximum_time": high[1],
                "end": float(values[-1]),
            }
    return {
        "title": result.scene.title,
        "medium": result.medium.name,
        "end_time": float(result.t[-1]),
        "order": result.resolution.s,
        "slab": result.resolution.h,
        "slabs": len(result.t) - 1,
        "line_end_samples": result.samples,
        "seconds": result.seconds,
        "probes": probes,
        "notes": list(result.notes),
    }


def as_table(result: Result) -> str:
    """The same for the eye, in handy units."""
    told = summary(result)
    slab, slab_unit = handy(told["slab"], "s")
    second, time_unit = handy(told["end_time"], "s")
    head = [
        f"order {told['order']}, {told['slabs']} slabs of {told['slab'] / slab:.4g} {slab_unit}, "
        f"{told['line_end_samples']:,} line-end samples in {told['seconds']:.2g} s",
        "",
    ]
    at = f"at [{time_unit}]"
    rows = [["probe", "quantity", "minimum", at, "maximum", at, "at the end"]]
    for name, probe in told["probes"].items():
        for k, (word, _, _, shown) in enumerate(quantities(result.medium)):
            seen = probe[word]
            size, unit = handy(max(abs(seen["minimum"]), abs(seen["maximum"])), shown)
            numbers = [
                seen["minimum"] / size,
                seen["minimum_time"] / second,
                seen["maximum"] / size,
                seen["maximum_time"] / second,
                seen["end"] / size,
            ]
            texts = (f"{number:.4g}" for number in numbers)
            rows.append(["" if k else name, f"{word} [{unit}]", *texts])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    table = [
        "  ".join(
            cell.ljust(width) if k < 2 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    return "\n".join([*([result.scene.title] if result.scene.title else []), *head, *table])
