"""Loads and multiports from Touchstone files: rational models, proved passive."""

from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import PrivateAttr, ValidationInfo, model_validator

from tline.errors import InputError
from tline.scene.element import AtNode, Measured, OneMedium, optional, required
from tline.scene.line import Cable, SceneLine
from tline.scene.multiport import PortNodes
from tline.scene.ports import Multiport, Ports
from tline.scene.quantity import FIT_TOLERANCE, Quantity, Role
from tline.scene.rational import Ratio, RationalImpedance
from tline.scene.text_file import beside

if TYPE_CHECKING:
    from passivity import DelayedModel, RationalFunction

Tolerance = Annotated[Quantity, FIT_TOLERANCE]
Delay = Annotated[Quantity, Role("delay", "s", at_least=0)]


class Touchstone(Measured, OneMedium, RationalImpedance, AtNode):
    """Measured one-port, such as an antenna: the S-parameters of a Touchstone file.

    A rational model is fitted to the file's reflection, with as few poles as the tolerance allows; a delay in front, as
    of the cable to it, is extracted first and becomes a lossless line of the file's reference resistance. The model is
    proved passive, or refused. Beyond the file's frequencies it is an extrapolation.

    Raises
    ------
    InputError
        The file cannot be read, holds no one-port, no model meets the tolerance, or the model is not passive.
    """

    medium, instead = "electrical", "kind = 'impedance'"
    kind: Literal["touchstone"] = "touchstone"
    file: str = required("Touchstone file, `.s1p` or `.ts`, looked for beside the scene file")
    tolerance: Tolerance = optional("largest distance of the model's S from the file's", Quantity(1e-3, ""))
    delay: Delay | None = optional("time to the one-port, one way; found if not given")
    nearest: bool = optional("whether to take the nearest passive model where the fit is not passive", False)
    _model: "DelayedModel" = PrivateAttr()
    _near: str | None = PrivateAttr(default=None)  # node at which the delay begins

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo):
        delay = None if self.delay is None else float(self.delay)
        self._model = read_model(self.file, info, float(self.tolerance), delay, self.nearest)
        self._ratio = Ratio.of(_impedance(self._model))
        return self

    @property
    def model(self) -> "DelayedModel":
        """Fitted model, with its proof of passivity."""
        return self._model

    @property
    def near(self) -> str:
        """Node named in the scene, also with a delay."""
        return self._near or self.at

    @property
    def z0(self) -> float:
        """Reference resistance of the file, ohm."""
        return float(self._model.samples.z0[0])

    @property
    def delay_lines(self) -> set[str]:
        """Name of the delay line, and of the node behind it."""
        return {self.at} - {self.near}

    def taken_apart(self, own: str) -> tuple[dict[str, dict[str, SceneLine]], "Touchstone"]:
        """Return the delay line, named after its own place, and the one-port behind it."""
        if not self._model.delay:
            return {}, self
        line = Cable(**{"nodes": (self.near, own), "z0": self.z0, "delay": self._model.delay})
        moved = self.model_copy(update={"at": own})
        moved._near = self.near
        return {"lines": {own: line}}, moved


@lru_cache(maxsize=64)
def model_of(path: Path, stamp: int, tolerance: float, delay: Any, nearest: bool, ports: int = 1) -> "DelayedModel":
    """Fit the passive model of a file; `stamp` is the file's time of modification, as a scene is read several times."""
    from passivity import ExpressionError, Status, fit_scattering, read_touchstone

    response = read_touchstone(path)
    if response.ports != ports:
        got = f"{response.ports} port{'s' * (response.ports > 1)}"
        told = ("not one port for each node", f"{ports}", got)
        raise ExpressionError("samples", *told if ports > 1 else ("not a reflection", "S of one port", f"S of {got}"))
    found = fit_scattering(response, tolerance, nearest, delay)
    if nearest and not found.meets(tolerance):
        problem = f"the nearest passive model with {found.order} poles is not that near to the samples"
        raise ExpressionError("tolerance", problem, f"at least {found.error:.3g}", f"{tolerance:g}")
    if found.verdict.status is not Status.PROVED:
        problem = f"the model with {found.order} poles is not proved passive: {found.why}"
        undecided = ports > 1 and found.verdict.status is not Status.REFUTED
        expected = "fewer poles, by a larger tolerance" if undecided else "nearest = true, or another tolerance"
        raise ExpressionError("", problem, expected)
    return found


def _impedance(found: "DelayedModel") -> "RationalFunction":
    """Impedance Z = z0 (1 + S)/(1 - S) without the delay, exact for the poles and residues found."""
    from passivity import RationalFunction

    S, z0 = found.model.rational(), Fraction(found.samples.z0[0])
    assert isinstance(S, RationalFunction), "a file of one port"
    return RationalFunction((S.q + S.p) * z0.numerator, (S.q - S.p) * z0.denominator)


def read_model(file: str, info: ValidationInfo, *asked: Any) -> "DelayedModel":
    """Read the model of a file relative to the scene's folder, once for each modification."""
    from passivity import ExpressionError

    path = beside(file, info)
    try:
        return model_of(path, path.stat().st_mtime_ns if path.is_file() else 0, *asked)
    except (ExpressionError, OSError, ValueError) as error:
        raise _told(file, error) from None


def _told(file: str, error: ValueError | OSError) -> InputError:
    """Explain the error in the file, or in the request."""
    from passivity import ExpressionError

    if not isinstance(error, ExpressionError):
        return InputError("file", f"'{file}' cannot be read")
    if error.where == "tolerance":
        return InputError("tolerance", error.problem, error.expected, error.got)
    at = "" if file in error.where or error.where == "samples" else f"{error.where}: "
    return InputError("file", f"'{file}': {at * bool(error.where)}{error.problem}", error.expected, error.got)


MOST_PORTS = 8  # proofs with more take minutes


class MeasuredMultiport(Measured, OneMedium, Multiport):
    """Measured network such as a filter, a connector or a cable: the S-parameters of a Touchstone file.

    A rational model whose entries have common poles is fitted to the file's S, with as few poles as the
    tolerance allows, and proved passive, or refused. Delays in front of the ports are extracted
    first and become lossless lines of the file's reference resistances; if not given, they are estimated
    for up to four ports. Beyond the file's frequencies the model is an extrapolation.

    Raises
    ------
    InputError
        The file cannot be read, its ports are not as many as the nodes, no model meets the tolerance, or the model is
        not passive.
    """

    medium, instead = "electrical", "kind = 'junction'"
    kind: Literal["touchstone"] = "touchstone"
    nodes: PortNodes = required(f"one for each port, 2 to {MOST_PORTS}, in the file's order")
    file: str = required("Touchstone file, `.s2p` and the like or `.ts`, looked for beside the scene file")
    tolerance: Tolerance = optional("largest distance of an entry of the model's S from the file's", Quantity(1e-3, ""))
    delays: tuple[Delay, ...] | None = optional("time from each node to its port, one way; looked for if not given")
    nearest: bool = optional("whether to take the nearest passive model where the fit is not passive", False)
    _model: "DelayedModel" = PrivateAttr()
    _near: tuple[str, ...] | None = PrivateAttr(default=None)  # nodes at which the delays begin

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo):
        k = len(self.nodes)
        if k > MOST_PORTS:
            raise InputError("nodes", "too many ports", f"at most {MOST_PORTS}", f"{k}")
        if self.delays is not None and len(self.delays) != k:
            raise InputError("delays", "not one for each node", f"{k}", f"{len(self.delays)}")
        delays = None if self.delays is None else tuple(map(float, self.delays))
        self._model = read_model(self.file, info, float(self.tolerance), delays, self.nearest, k)
        return self

    @property
    def model(self) -> "DelayedModel":
        """Fitted model, with its proof of passivity."""
        return self._model

    @property
    def near(self) -> tuple[str, ...]:
        """Nodes named in the scene, also with delays."""
        return self._near or self.nodes

    @property
    def delay_lines(self) -> set[str]:
        """Names of the delay lines, and of the nodes behind them."""
        return set(self.nodes) - set(self.near)

    def taken_apart(self, own: str) -> tuple[dict[str, dict[str, SceneLine]], "MeasuredMultiport"]:
        """Return the delay lines, named after their own place, and the multiport behind them."""
        lines, nodes = {}, list(self.near)
        for k in np.flatnonzero(self._model.delay):
            z0, delay = float(self._model.samples.z0[k]), float(self._model.delay[k])
            nodes[k] = f"{own}.{k + 1}"
            lines[nodes[k]] = Cable(**{"nodes": (self.near[k], nodes[k]), "z0": z0, "delay": delay})
        moved = self.model_copy(update={"nodes": tuple(nodes)})
        moved._near = self.near
        return {"lines": lines}, moved

    def ports(self) -> Ports:
        """Equations of the multiport: S between waves (u + z0·i)/√z0 and (u - z0·i)/√z0."""
        (A, B, C, D), root = self._model.model.realised(), np.sqrt(self._model.samples.z0)
        one = np.eye(len(D))
        return Ports((one - D) / root, -(one + D) * root, C, A, B / root, B * root)
