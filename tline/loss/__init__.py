"""What a lossy line is: exact laws of its impedance and admittance per metre, and passive circuits that come close.

The laws are functions of the Laplace variable that are analytic off the negative real axis. A line is made of two of
them (`LossyLine`), and `realise` turns a law into a circuit of resistors and inductors (or conductors and capacitors).
"""

from tline.loss.constant import ConstantLoss
from tline.loss.dielectric import DielectricLoss
from tline.loss.earth import EarthReturn
from tline.loss.foster import Foster
from tline.loss.laminar import LaminarFriction, hagen_poiseuille
from tline.loss.law import Law, Sum
from tline.loss.line import LossyLine
from tline.loss.realise import Realisation, realise
from tline.loss.skin import RoundWire, SkinEffect
from tline.loss.table import tabulated
from tline.loss.turbulent import TurbulentFriction, smooth_pipe_resistance
from tline.loss.wall import kelvin_voigt_wall

__all__ = [
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
