"""Lossy lines: exact laws of their impedance and admittance per metre, and passive circuits that approximate them.

The laws are functions of the Laplace variable that are analytic off the negative real axis. A line is made of two of
them (`LossyLine`), and `realise` turns a law into a circuit of resistors and inductors (or conductors and capacitors).
"""

from tline.loss.cables import DielectricLoss, EarthReturn, RoundWire, SkinEffect
from tline.loss.foster import Foster, tabulated
from tline.loss.law import ConstantLoss, Law, Sum
from tline.loss.line import LossyLine
from tline.loss.pipes import (
    ChangingLaminarFriction,
    LaminarFriction,
    TurbulentFriction,
    hagen_poiseuille,
    kelvin_voigt_wall,
    smooth_pipe_resistance,
)
from tline.loss.realise import Realisation, realise

__all__ = [
    "ChangingLaminarFriction",
    "ConstantLoss",
    "DielectricLoss",
    "EarthReturn",
    "Foster",
    "LaminarFriction",
    "Law",
    "LossyLine",
    "Realisation",
    "RoundWire",
    "SkinEffect",
    "Sum",
    "TurbulentFriction",
    "hagen_poiseuille",
    "kelvin_voigt_wall",
    "realise",
    "smooth_pipe_resistance",
    "tabulated",
]
