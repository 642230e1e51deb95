"""A verdict may be undecided, so it is neither true nor false: who asks so hears what to ask instead."""

import numpy as np
import pytest

import passivity
from passivity import PoleResidueModel, RationalFunction, Status
from passivity.status import Decided
from tline.solver.description.passive import CircuitVerdict

FUNCTION = RationalFunction.from_expression
CHAIN = passivity.check_line(FUNCTION("1+s"), 50, 1)
VERDICTS = [
    passivity.check_positive_real(FUNCTION("1/(1+s)")),
    passivity.check_positive_real(FUNCTION("-1")),
    passivity.check_bounded_real(FUNCTION("2")),
    passivity.is_bounded_real("exp(-s)"),
    passivity.is_positive_real("R + s*L", ["R > 0", "L > 0"]),
    passivity.check_line_two_port(50, 1),
    passivity.is_positive_real("Z2 + s", ["Z2 positive real"]),
    passivity.derive("25", "50", "1"),
    passivity.check_bounded_real(passivity.RationalMatrix.from_rows([["3/5", "4/5"], ["4/5", "-3/5"]])),
    passivity.check_samples(passivity.SampledResponse([1.0, 2.0], [0.5, 0.25], "S")),
    passivity.nearest(PoleResidueModel(np.zeros(0), np.zeros((0, 1, 1)), np.array([[2.0]]))),
    CHAIN,
    CircuitVerdict(["loads.a", "loads.b"], ["a"], Status.UNDECIDED, "too many ports"),
]


@pytest.mark.parametrize("verdict", VERDICTS, ids=lambda verdict: type(verdict).__name__)
def test_the_truth_of_a_verdict_is_an_error(verdict):
    said = r"^a verdict is neither true nor false, expected its \.proved, \.refuted or \.status$"
    for asked in (bool, lambda x: "passive" if x else "active", lambda x: not x, lambda x: x and 1):
        with pytest.raises(TypeError, match=said):
            asked(verdict)
    assert verdict.proved == (verdict.status is Status.PROVED)
    assert verdict.refuted == (verdict.status is Status.REFUTED)


@pytest.mark.parametrize("status", Status)
def test_nor_is_a_status_true(status):
    with pytest.raises(
        TypeError, match=r"^a status is neither true nor false, expected a comparison such as `is Status"
    ):
        bool(status)


def test_all_that_have_a_status_are_asked_here():
    def below(kind):
        return {kind, *(inner for each in kind.__subclasses__() for inner in below(each))}

    assert {type(verdict) for verdict in VERDICTS} == below(Decided) - {Decided}
    handed_out = [getattr(passivity, name) for name in dir(passivity)]
    with_status = {
        each
        for each in handed_out
        if isinstance(each, type) and "status" in {*each.__dict__, *getattr(each, "__annotations__", {})}
    }
    assert with_status <= below(Decided)
