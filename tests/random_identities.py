"""Positive real functions by construction, and forms that are positive or bounded real with them."""

from random import Random

from passivity import is_bounded_real, is_positive_real

ASSUME = ["R > 0", "L >= 0", "T > 0", "Z2 positive real", "H bounded real"]
FORMS = {
    "Cayley": ("({0} - 1)/({0} + 1)", is_bounded_real),
    "Cayley of a multiple": ("(R - {0})/(R + {0})", is_bounded_real),
    "exponential": ("exp(-{0})", is_bounded_real),
    "tanh": ("tanh({0})", is_positive_real),
    "inverse": ("1/{0}", is_positive_real),
    "inverse of the inverse": ("1/(1/{0})", is_positive_real),
    "merged": ("2*{0}/3 + {0}/3", is_positive_real),
    "factored": ("(R*{0} + T*{0})/(R + T)", is_positive_real),
    "parallel": ("{0}*R/({0} + R)", is_positive_real),
    "behind a line": ("R*({0} + R*tanh(T*s))/(R + {0}*tanh(T*s))", is_positive_real),
    "reflected": ("(1 + exp(-2*T*s)*({0} - R)/({0} + R))/(1 - exp(-2*T*s)*({0} - R)/({0} + R))", is_positive_real),
}


def impedance(random: Random, depth: int, functions: bool) -> str:
    """A positive real function by construction."""
    if depth == 0:
        return random.choice(["s", "R", "Z2", "L*s", "3", "(s + 2)", "1/(s + R)", "(1 + H)"])
    x, y = (impedance(random, depth - 1, functions) for _ in range(2))
    made = [f"({x} + {y})", f"1/({x} + {y})", f"7/3*{x}", f"1/(1/{x} + R)", f"line(R, T*s, {x})"]
    if functions:
        made += [f"sqrt({x}*{y})", f"tanh({x})", f"(1 - exp(-{x})/2)", f"log(1 + {x})"]
    return random.choice(made)
