"""The nearest passive model of several ports beside closed forms, and as foreign singular values see it."""

import numpy as np
import pytest
from click.testing import CliRunner

from passivity import PoleResidueModel, SampledResponse, Status, nearest, read_touchstone
from passivity.sampled.enforce import SPARE
from tline.cli.passivity import passivity

FAR = 1e9  # rad/s: stands for infinity


def turned(values, seed):
    """A diagonal of values between two fixed orthogonal matrices, which change no singular value and no distance."""
    rng = np.random.default_rng(seed)
    u, v = (np.linalg.qr(rng.normal(size=(len(values), len(values))))[0] for _ in range(2))
    return u, v, u @ np.diag(values) @ v.T


@pytest.mark.parametrize("ports", [2, 3])
def test_each_singular_value_is_cut_off_at_1(ports):
    """D + R/(s + 1) with one sample at each end: each end is moved to the nearest matrix of norm 1 on its own."""
    ends = np.linspace(1.2, 0.3, ports), np.linspace(0.1, 1.4, ports)
    u, v, high = turned(ends[1], ports)
    model = PoleResidueModel(np.array([-1.0]), (u @ np.diag(ends[0] - ends[1]) @ v.T)[None], high)
    w = np.array([0, FAR])
    from passivity import enforce

    found = enforce(model, SampledResponse(w / (2 * np.pi), model.at(w), "S"))
    assert found.status is Status.PROVED
    least = np.sqrt(sum((np.maximum(x - 1, 0) ** 2).sum() for x in ends) / sum((x**2).sum() for x in ends))
    assert found.change.rms == pytest.approx(least, rel=1e-3)
    assert np.linalg.norm(found.model.at(w), 2, axis=(1, 2)) == pytest.approx([1, 1], abs=2 * SPARE)
    assert found.worst[0][0] == pytest.approx(1.4, rel=1e-6)


def test_an_eigenvalue_of_impedances_is_lifted_to_zero():
    """Two resistive ports coupled too much: the nearest semidefinite matrix has the negative eigenvalue at zero."""
    z = np.array([[1.0, 2.0], [2.0, 1.0]])
    found = nearest(PoleResidueModel(np.zeros(0), np.zeros((0, 2, 2)), z, 0.0, "Z"))
    assert found.status is Status.PROVED
    assert found.model.constant == pytest.approx(np.full((2, 2), 1.5), abs=1e-4)
    assert found.worst[0][0] == pytest.approx(-1)


def test_from_a_file_to_a_file(tmp_path):
    """A filter measured a little beyond 1; what is written is read again, and no foreign singular value exceeds 1."""
    f = np.linspace(1e8, 3e9, 60)
    s = 2j * np.pi * f / 1e9
    notch = (s**2 + 4) / (s**2 + 2 * s + 4)
    S = np.array([[1 - notch, notch], [notch, 1 - notch]]).transpose(2, 0, 1) * 1.01
    SampledResponse(f, S, "S", 75).touchstone()
    (tmp_path / "in.s2p").write_text(SampledResponse(f, S, "S", 75).touchstone())
    assert (read_touchstone(tmp_path / "in.s2p").values == S).all()
    out = tmp_path / "out.s2p"
    result = CliRunner().invoke(passivity, [str(tmp_path / "in.s2p"), "--nearest", str(out)])
    assert result.exit_code == 0, result.output
    assert "largest singular value of S = 1.01 before, 1 after" in result.output
    after = read_touchstone(out)
    assert after.z0.tolist() == [75, 75]
    assert np.linalg.norm(after.values, 2, axis=(1, 2)).max() <= 1
    assert np.abs(after.values - S).max() < 0.011
