"""What samples showed, and the nearest passive model, as plain data; exact numbers are texts."""

from typing import Any

from passivity.one_port.certificate import verify
from passivity.sampled.check import SampleVerdict
from passivity.sampled.enforce import Enforced
from passivity.sampled.model import PoleResidueModel


def samples_as_dict(verdict: SampleVerdict, enforced: Enforced | None = None) -> dict[str, Any]:
    """What JSON can hold of a verdict on samples and of a model.

    Examples
    --------
    >>> from passivity.sampled.check import check_samples
    >>> from passivity.sampled.response import SampledResponse
    >>> samples_as_dict(check_samples(SampledResponse([1, 2], [0.5, 1.5], "S")))["bands"][0]["worst"]
    1.5
    """
    response, witness = verdict.response, verdict.witness
    told: dict[str, Any] = {
        "parameter": response.parameter.value,
        "ports": response.ports,
        "z0": response.z0.tolist(),
        "status": verdict.status.value,
        "worst": verdict.worst_value,
        "worst_frequency": verdict.worst_frequency,
        "excess": verdict.worst_excess,
        "allowed": verdict.worst_bar,
        "allowed_by": "digits" if verdict.by_digits else "error",
        "bands": [band._asdict() for band in verdict.bands],
        "caveats": list(verdict.caveats),
        "grid": {"samples": len(response.f), "first": float(response.f[0]), "last": float(response.f[-1])},
    }
    if witness:
        told["witness"] = {
            "sample": witness.sample,
            "frequency": witness.frequency,
            "vector": [[v.real, v.imag] for v in witness.vector],
            "value": str(witness.value),
            "bar": str(witness.bar),
        }
    if enforced:
        certificate = enforced.verdict.certificate
        told["model"] = _model(enforced.model) | {
            "status": enforced.verdict.status.value,
            "why": enforced.verdict.why,
            "verified": certificate is not None and verify(certificate),
            "rounds": enforced.rounds,
            "change": enforced.change._asdict(),
            "misfit": enforced.misfit._asdict(),
        }
        told["fitted"] = _model(enforced.original) | {"misfit": enforced.misfit_before._asdict()}
    return told


def _model(model: PoleResidueModel) -> dict[str, Any]:
    return {
        "poles": [[a.real, a.imag] for a in model.poles.tolist()],
        "residues": [[r.real, r.imag] for r in model.residues.tolist()],
        "constant": model.constant,
        "proportional": model.proportional,
    }
