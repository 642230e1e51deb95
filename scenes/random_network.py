"""Writes a scene of 1000 cables joined at random: python scenes/random_network.py > network.toml."""

import random
import sys

import tomli_w

LINES, NODES, SEED = 1000, 700, 1


def network(lines: int = LINES, nodes: int = NODES, seed: int = SEED) -> dict:
    """Tables of a connected network: a tree plus random chords, loads at a third of the nodes, one source."""
    draw = random.Random(seed)
    pairs = [(draw.randrange(k), k) for k in range(1, nodes)]
    pairs += [(draw.randrange(nodes), draw.randrange(nodes)) for _ in range(lines - len(pairs))]
    loads = {}
    for k in range(1, nodes, 3):
        kind = draw.choice(["resistor", "parallel"])
        loads[f"load{k}"] = {"at": f"n{k}", "kind": kind, "resistance": f"{draw.randint(20, 500)} ohm"}
        if kind == "parallel":
            loads[f"load{k}"]["capacitance"] = f"{draw.randint(20, 100)} pF"
    return {
        "title": f"{lines} cables joined at random",
        "medium": "electrical",
        "t_end": "2 us",
        "lines": {
            f"l{k}": {
                "nodes": [f"n{one}", f"n{two}"],
                "z0": f"{draw.choice([50, 60, 75, 93])} ohm",
                "delay": f"{draw.randint(20, 80)} ns",
            }
            for k, (one, two) in enumerate(pairs)
        },
        "sources": {
            "source": {
                "at": "n0",
                "kind": "voltage",
                "resistance": "50 ohm",
                "value": {"shape": "ramp", "to": "1 V", "duration": "10 ns"},
            }
        },
        "loads": loads,
        "probes": {"last": {"at": f"n{nodes - 1}", "line": f"l{nodes - 2}"}},
    }


if __name__ == "__main__":
    sys.stdout.write(tomli_w.dumps(network()))
