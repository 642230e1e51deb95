"""EPANET files as other programs ship them, read, compared and held still: python -m benchmarks.foreign_networks
NAME=FOLDER...

Each .inp file below a folder is given to EPANET's library as it is, and to `read_inp`. Prints a table and writes it to
docs/benchmarks-foreign.md. Each file is run in a process of its own; needs tline[epanet].
"""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from tline.errors import InputError
from tline.interchange.confined import solved
from tline.interchange.epanet import FOOT, HIGHEST, TRADITIONAL, read_epanet
from tline.interchange.epanet_text import read_text
from tline.interchange.pipe_walls import wave_speeds
from tline.interchange.water_scene import water_scene
from tline.scene.scene import Scene
from tline.scene.site import GRAVITY
from tline.solver.description.description import describe
from tline.solver.simulate import simulate
from tline.solver.steady.steady_state import steady_state

ROOT = Path(__file__).parent.parent
SPEED, HELD = "1000 m/s", 60  # s
WALLS = wave_speeds(SPEED, None)
LONGEST = 3000  # s, of a file
UNFINISHED, CELLS = f"not held to the end within {LONGEST} s of a shared machine", 7
AGREES, ACCURATE = 1e-3, 1e-3  # of the range of heads; m
STILL = 1e-9  # of the largest pressure


def heads(path: Path) -> dict[str, float]:
    """Heads that EPANET itself finds for the whole file, m."""
    answer = solved(str(path), read_text(str(path)))
    unit = FOOT if answer["units"] < TRADITIONAL else 1.0
    return {node["name"]: node["head"] * unit for node in answer["nodes"]}


def measured(path: Path) -> Iterator[dict[str, Any]]:
    """Figures of a file, then all of them; what EPANET or the import says of one that cannot be read."""
    try:
        own = heads(path)
    except InputError as error:
        yield {"epanet": error.problem + (f": {error.got}" if error.got else "")}
        return
    lost = [name for name, head in own.items() if not (isfinite(head) and abs(head) < HIGHEST)]
    found: dict[str, Any] = {"nodes": len(own), "lost": len(lost)}
    try:
        network = read_epanet(path)
        scene, _ = water_scene(network, WALLS)
        effort, _ = steady_state(describe(scene))
    except InputError as error:
        yield found | {"refused": str(error).removeprefix(f"{path}: ")}
        return
    there = [name for name in own if name in effort]
    spread = max(own[name] for name in there) - min(own[name] for name in there)
    metre = network.density * GRAVITY
    off = max(abs(effort[name] / metre - own[name]) for name in there)
    found |= {"pipes": len(network.pipes), "compared": len(there), "off": off, "share": off / (spread or 1.0)}
    yield found
    held = Scene(**scene.table() | {"t_end": HELD, "solver": {"order": 1}})
    begun = time.process_time()
    seen = simulate(held, envelope=True, ledger=False).envelope
    assert seen is not None
    moved = np.maximum(seen.highest - seen.start, seen.start - seen.lowest).max()
    moved /= max(np.abs(seen.start).max(), metre)
    yield found | {"moved": float(moved), "seconds": time.process_time() - begun}


def in_a_process(path: Path) -> dict[str, Any]:
    call = [sys.executable, "-W", "ignore", "-m", "benchmarks.foreign_networks", "one", str(path)]
    try:
        done = subprocess.run(call, check=True, capture_output=True, cwd=ROOT, timeout=LONGEST).stdout
    except subprocess.TimeoutExpired as error:
        return (json.loads(error.stdout.splitlines()[-1]) if error.stdout else {}) | {"broken": UNFINISHED}
    except subprocess.CalledProcessError as error:
        return {"broken": error.stderr.decode().strip().splitlines()[-1][:200]}
    return json.loads(done.splitlines()[-1])


def row(name: str, file: str, found: dict[str, Any]) -> str:
    """A row of the table."""
    cells = [f"{found[key]:,}" if key in found else "" for key in ("nodes", "pipes", "compared")]
    if "off" in found:
        cells += [f"{1e3 * found['off']:.2g}", f"{found['share']:.0e}"]
    if "moved" in found:
        cells += ["< 1e-12" if found["moved"] < 1e-12 else f"{found['moved']:.0e}", f"{found['seconds']:.3g}"]
    cells += [""] * (CELLS - len(cells))
    said = [f"EPANET: {found['epanet']}"] if "epanet" in found else []
    said += [f"heads of {found['lost']} nodes are none in EPANET's own answer"] if found.get("lost") else []
    said += [found[key] for key in ("refused", "broken") if key in found]
    return "| " + " | ".join([name, file, *cells, "; ".join(said).replace("|", "/")]) + " |\n"


def counts(rows: list[tuple[str, str, dict[str, Any]]]) -> str:
    """How many files of each source are read, agree and stay."""
    text = "| from | files | EPANET finds all heads | read | agree | held | stay |\n" + "|---" + "|---:" * 6 + "|\n"
    for name in dict.fromkeys(name for name, _, _ in rows):
        own = [found for one, _, found in rows if one == name]
        read = [found for found in own if "off" in found]
        agree = sum(found["share"] <= AGREES or found["off"] <= ACCURATE for found in read)
        held = [found["moved"] for found in read if "moved" in found]
        stay, sound = sum(moved <= STILL for moved in held), sum(found.get("lost") == 0 for found in own)
        text += f"| {name} | {len(own)} | {sound} | {len(read)} | {agree} | {len(held)} | {stay} |\n"
    return text


PAGE = f"""# Networks of other programs

Written by `python -m benchmarks.foreign_networks`: all `.inp` files that come with other programs, read as `tline
import` does, with {SPEED} in all pipes. EPANET's own library is given each file as it is, and the heads of the
scene's own steady state are compared with its heads, where both have the node: *off* is the largest difference,
*share* that over the range of heads. Then nothing is operated for {HELD} s (one run of order 1, extremes at all
nodes): *moved* is the most that the pressure of any node leaves the steady one, over the largest, or over that of 1
m; *CPU* what that takes. A file *agrees* within {AGREES:g} of the range, or within
{1e3 * ACCURATE:g} mm; it *stays* within {STILL:g}.

"""
HEADER = """
| from | file | nodes | pipes | compared | off, mm | share | moved | CPU, s | |
|---|---|---:|---:|---:|---:|---:|---:|---:|---|
"""

if __name__ == "__main__":
    if sys.argv[1:2] == ["one"]:
        for figures in measured(Path(sys.argv[2])):
            print(json.dumps(figures), flush=True)
    else:
        rows = []
        for given in sys.argv[1:]:
            name, _, folder = given.partition("=")
            for path in sorted(Path(folder).rglob("*.inp"), key=lambda p: p.name.lower()):
                rows.append((name, path.name, in_a_process(path)))
                print(row(*rows[-1]), end="", flush=True)
        text = PAGE + counts(rows) + HEADER + "".join(row(*one) for one in rows)
        (ROOT / "docs" / "benchmarks-foreign.md").write_text(text, encoding="utf-8")
