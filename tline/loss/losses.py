"""What a line loses, as exact laws: those over frequency, and friction that depends on the flow itself."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from tline.loss.constant import ConstantLoss
from tline.loss.flow_law import FlowLaw, PowerLaw
from tline.loss.line import LossyLine


@dataclass(frozen=True)
class Losses:
    """Of one line."""

    exact: LossyLine  # all that is linear; its storages are those of the lossless line, which a front meets
    # what is added to the drop of pressure per metre and depends on the size of the flow
    flow_law: FlowLaw | None = None

    @property
    def linear(self) -> bool:
        """Whether nothing depends on the size of the flow."""
        return self.flow_law is None

    @property
    def quadratic(self) -> float:
        """K, Pa s²/m⁷, if the law of flow is K |y| y; else 0."""
        law = self.flow_law
        return law.strength if isinstance(law, PowerLaw) and law.exponent == 2 else 0.0

    @property
    def constant(self) -> tuple[float, float] | None:
        """Resistance and conductance per metre, if that is all."""
        laws = self.exact.series, self.exact.shunt
        if not self.linear or not all(isinstance(law, ConstantLoss) for law in laws):
            return None
        return laws[0].loss, laws[1].loss

    @property
    def only_quadratic(self) -> bool:
        """Whether K |y| y is all that is lost."""
        laws = self.exact.series, self.exact.shunt
        plain = all(isinstance(law, ConstantLoss) and not law.loss for law in laws)
        return self.quadratic > 0 and plain

    @property
    def distortionless(self) -> bool:
        """Whether the line only delays and attenuates."""
        return self.linear and self.exact.distortionless

    @property
    def attenuation(self) -> float:
        """l sqrt(R G): what a distortionless line takes from the logarithm of a wave."""
        return self.exact.length * sqrt(self.exact.series.loss * self.exact.shunt.loss)

    def friction(self, y: NDArray) -> tuple[NDArray, NDArray]:
        """Drop over the whole line that depends on the size of the flow y, and its slope."""
        if self.flow_law is None:
            return np.zeros_like(y), np.zeros_like(y)
        drop, slope = self.flow_law(np.abs(y))
        return np.sign(y) * drop * self.exact.length, slope * self.exact.length

    def steady_drop(self, y: float) -> tuple[float, float]:
        """Fall of the effort from end 1 to end 2 in steady flow y, and its slope over y; leakage is not in it."""
        drop, slope = self.friction(np.array(float(y)))
        resistance = self.exact.series.loss * self.exact.length
        return float(drop) + resistance * y, float(slope) + resistance
