"""Compiled code of the package: it knows arrays and numbers and nothing else."""

from friction.kernel.automaton import automaton
from friction.kernel.fixed import march
from friction.kernel.law import (
    BLOWN_UP,
    BRISTLE,
    BUDGET,
    DONE,
    FA,
    FF,
    MODE,
    SIGN,
    STALLED,
    TANH,
    ZONE,
    Drive,
    Law,
    applied,
    friction,
    jacobian,
    push_at,
    respond,
    slopes,
    steady,
)
from friction.kernel.roots import first_root

__all__ = [
    "BLOWN_UP",
    "BRISTLE",
    "BUDGET",
    "DONE",
    "FA",
    "FF",
    "MODE",
    "SIGN",
    "STALLED",
    "TANH",
    "ZONE",
    "Drive",
    "Law",
    "applied",
    "automaton",
    "first_root",
    "friction",
    "jacobian",
    "march",
    "push_at",
    "respond",
    "slopes",
    "steady",
]
