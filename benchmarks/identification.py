"""How often parameters of random laws are found within two deviations: `python -m benchmarks.identification [TRIALS]`.

Records are those of tests/identified.py: forces by SciPy under a prescribed motion, with 1 % noise.
"""

import sys
import time

import numpy as np

from benchmarks import harness  # noqa: F401 (finds the helpers of the tests)
from friction import MODELS, identify


def main(trials: int) -> None:
    """Print one row for each law."""
    from identified import TIMES, VELOCITY, random_law, record

    print("| law | trials | parameters within 2σ | of | share | median CPU [s] | most |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for number, name in enumerate(MODELS):
        within, total, seconds = 0, 0, []
        for trial in range(trials):
            rng = np.random.default_rng((31, number, trial))
            law = random_law(name, rng)
            force = record(law, rng)
            begun = time.process_time()
            found = identify(TIMES, force, velocity=VELOCITY, models=(name,)).fits[name]
            seconds.append(time.process_time() - begun)
            within += sum(
                abs(getattr(law, key) - value) <= 2.0 * found.deviations[key] for key, value in found.parameters.items()
            )
            total += len(found.parameters)
        row = f"| {name} | {trials} | {within} | {total} | {within / total:.3f} "
        print(f"{row}| {np.median(seconds):.2f} | {max(seconds):.2f} |", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
