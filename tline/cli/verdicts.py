"""Answers of `tline passivity`: on expressions and matrices, on samples, and on the elements of a scene."""

import json
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Output, drawn
from tline.cli.options import write_text
from tline.errors import InputError
from tline.words.wording import first_of, place

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from passivity import Margins, Verdict
    from passivity.sampled.response import SampledResponse
    from tline.solver.description.passive import CircuitVerdict

EXIT = {"proved": 0, "refuted": 1, "undecided": 3, "no violation seen": 3}
MOST_NODES = 6  # nodes of a circuit named
OPAQUE = re.compile(r"^[^=]*\s(pr|br|positive real|bounded real)\s*$", re.IGNORECASE)
ASSUMPTION = re.compile(rf"[<>]|\s+real\s*$|{OPAQUE.pattern}", re.IGNORECASE)
STRUCTURE = re.compile(r"\blet\s|\bline\s*\(|[;\n]")


@dataclass(frozen=True)
class Asked:
    """Options of the command, as typed; None or empty where not given."""

    kind: str | None
    parameters: tuple[str, ...]
    z0: str | None
    delay: str | None
    within: str | None
    error: str | None
    nearest: str | None
    certificate: str | None = None
    sector: str | None = None
    supply: str | None = None
    confined: bool = False

    def refuse(self, about: str, *options: str) -> None:
        """Raise InputError for the first of these options that was given."""
        for option in options:
            if getattr(self, option) not in (None, (), False):
                name = {"parameters": "param"}.get(option, option)
                raise InputError(f"--{name}", f"says nothing about {about}", "another option, or none")


def answer(status: Any, lines: Iterable[str], told: dict[str, Any], **files: Callable[[str], Any]) -> Output:
    """Build the answer to one question, by its status."""
    return Output(lines, lambda: told, files, exit_code=EXIT[getattr(status, "value", status)])


def values(given: tuple[str, ...]) -> dict[str, str]:
    """Parse names and their values from NAME=VALUE."""
    found: dict[str, str] = {}
    for text in given:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError("--param", "not a name with a value", "NAME=VALUE such as R='50 ohm'", f"'{text:.60}'")
        if name in found:
            raise InputError(f"--param {name}", "given twice", "one value", f"'{found[name]:.30}' and '{value:.30}'")
        found[name] = value
    return found


def expression(text: str, asked: Asked) -> Output:
    """Decide an expression, or the file of one, by the method it needs."""
    from passivity import Kind
    from passivity.calculus.ask import of_text

    kind = Kind.BR if asked.kind == "br" else Kind.PR
    asked.refuse("expressions", "error", "nearest")
    text = _read(text) if text.lower().endswith(".txt") else text
    assumed = [given for given in asked.parameters if ASSUMPTION.search(given)]
    known = values(tuple(given for given in asked.parameters if given not in assumed))
    if asked.kind == "chain" and (STRUCTURE.search(text) or any(map(OPAQUE.search, assumed)) or asked.certificate):
        return _derived(text, asked, assumed, known)
    inside = _in_region(text, asked, assumed, known)
    verdict = of_text(text, kind, assumed, known) if inside is None else inside
    if verdict.function is not None:
        found = _one_port(verdict, asked)
        return found._replace(files={**found.files, "certificate": _certificate(verdict)})
    about = "functions with names" if assumed else "functions that are not rational"
    asked.refuse(about, "z0", "delay", "within")
    return _concluded(verdict, assumed)


def _in_region(what: Any, asked: Asked, assumed: Iterable[str] = (), known: Any = None) -> "Verdict | None":
    """The verdict on --sector or --supply, where one of these is asked about."""
    from passivity import is_dissipative, is_in_sector

    if asked.sector is None and asked.supply is None:
        return None
    asked.refuse("a sector or a supply", "kind", "z0", "delay", "within", *["supply"] * (asked.sector is not None))
    form, ask = ("LOW,HIGH", is_in_sector) if asked.supply is None else ("Q,S,R", is_dissipative)
    text = asked.sector or asked.supply or ""
    numbers = text.split(",")
    if len(numbers) != form.count(",") + 1:
        raise InputError("--sector" if asked.supply is None else "--supply", "not such numbers", form, f"'{text:.60}'")
    return ask(what, *numbers, assume=assumed, values=known)  # pyright: ignore[reportCallIssue]


def _derived(text: str, asked: Asked, assumed: list[str], known: dict[str, str]) -> Output:
    """Derive the input port's property from any load of a line."""
    from passivity import derive

    asked.refuse("the structure of a function", "within")
    if known:
        raise InputError("--param", "a value in a derivation", "it in place of the name")
    derived = derive(text, asked.z0 or "z0", asked.delay or "T", assumed)
    last = derived.statements[-1][1]
    return answer(last.status, derived.text_lines(), last.to_dict(), certificate=_certificate(last))


def _concluded(verdict: "Verdict", assumed: list[str]) -> Output:
    plot = {} if assumed else {"plot": drawn("tline.cli.verdicts:draw", verdict)}
    return answer(verdict.status, verdict.text_lines(), verdict.to_dict(), certificate=_certificate(verdict), **plot)


def draw(verdict: "Verdict") -> "Figure":
    """Draw a verdict, z0 = 1."""
    return verdict.plot()


def _certificate(verdict: "Verdict") -> Callable[[str], str | None]:
    """Return a writer of a file that anyone can check."""

    def save(file: str) -> str | None:
        if verdict.evidence is None:
            return "nothing was written: no proof along the expression, and no witness in reach"
        write_text(json.dumps(verdict.evidence, ensure_ascii=False) + "\n", file)

    return save


def verified(path: str) -> Output:
    """Check a file with a proof or a witness."""
    from passivity.calculus.proof import check_evidence, proved_by
    from passivity.verifier import FORMAT

    try:
        evidence = json.loads(_read(path))
    except ValueError as error:
        raise InputError(path, "not JSON", "a file written by --certificate", str(error)[:60]) from error
    if not isinstance(evidence, dict) or "format" not in evidence:
        raise InputError(path, "neither a proof nor a witness", "a file written by --certificate")
    wrong = check_evidence(evidence)
    what = f"the witness against {evidence.get('text')}"
    if evidence["format"] == FORMAT:
        what = evidence.get("statement") if wrong else proved_by(evidence)
    line = f"does not hold: {wrong}" if wrong else f"holds: {what}"
    return answer("refuted" if wrong else "proved", [line], {"holds": wrong is None, "wrong": wrong, "statement": what})


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(path, "cannot be read", "a text file", str(error)[:80]) from error


def _one_port(verdict: "Verdict", asked: Asked) -> Output:
    """Report all options given beside the verdict on a rational function."""
    from passivity import Margins, Status, check_line, margins, robustness
    from passivity.polynomial.sign import UndecidedError
    from passivity.report import as_dict, in_lines

    if verdict.kind == "bounded real":
        asked.refuse("reflections", "z0", "delay", "within")
    if verdict.is_discrete:
        asked.refuse("functions of z", "delay", "within")
    if asked.kind == "chain" and not (asked.z0 and asked.delay):
        missing = "delay" if asked.z0 else "z0"
        raise InputError(f"--{missing}", "is missing", "z0 and delay of the line that --kind chain looks through")
    z0, missing = "1" if asked.z0 is None else asked.z0, []
    try:
        found = margins(verdict, z0)
    except UndecidedError as error:
        found, missing = Margins(), [f"  margins not found: {error}"]
    tolerance = None if asked.within is None else _tolerance(asked.within)
    robust = None if tolerance is None or verdict.status is Status.UNDECIDED else robustness(verdict, tolerance)
    chain = None if asked.delay is None else check_line(verdict.function, z0, asked.delay)
    lines = in_lines(verdict, found, robust, z0) + missing + ([] if chain is None else ["", *chain.text_lines()])
    status = verdict.status if chain is None else chain.status
    plot = {} if chain is not None else {"plot": drawn("tline.cli.verdicts:draw_one_port", verdict, found, z0)}
    told = as_dict(verdict, found, robust) | ({} if chain is None else {"line": chain.to_dict()})
    return answer(status, lines, told, **plot)


def _tolerance(text: str) -> Fraction:
    """Parse a number, or a percentage such as "5 %"."""
    from passivity.rational.evaluate import exact

    number = text.strip().removesuffix("%")
    return exact(number, "tolerance") / (1 if number == text.strip() else 100)


def draw_one_port(verdict: "Verdict", margins: "Margins", z0: str) -> "Figure":
    """Draw Nyquist and Smith chart, or the magnitude of a reflection."""
    from passivity.exact.picture import draw_verdict
    from passivity.expression.number import double
    from passivity.rational.evaluate import exact

    return draw_verdict(verdict, margins, double(exact(z0, "z0")))


def matrix(text: str, asked: Asked) -> Output:
    """Decide a matrix of rational functions."""
    from passivity import Kind, RationalMatrix
    from passivity.budget import VERDICT, budget
    from passivity.calculus.ask import ask
    from passivity.discrete import Discrete

    asked.refuse("matrices", "z0", "delay", "within", "error", "nearest", "certificate")
    if not text.rstrip().endswith("]"):
        raise InputError("matrix", "its last bracket is missing", "[a, b; c, d]", f"'{text:.60}'")
    rows = [[entry.strip() for entry in row.split(",")] for row in text.strip()[1:-1].split(";")]
    given, kind = values(asked.parameters), Kind.BR if asked.kind == "br" else Kind.PR
    names = {name for row in rows for entry in row for name in re.findall(r"[^\W\d]\w*", entry)}
    discrete = "z" in names and "z" not in given and "s" not in names
    found = RationalMatrix.from_rows(rows, given, "z" if discrete else "s")
    with budget(2 * VERDICT):
        what = Discrete(found) if discrete else found
        inside = _in_region(what, asked)
        verdict = ask(what, kind) if inside is None else inside
    plot = drawn("tline.cli.verdicts:draw", verdict)
    return answer(verdict.status, verdict.text_lines(), verdict.to_dict(), plot=plot)


def samples(file: str, asked: Asked) -> Output:
    """Check the samples of a file; with --nearest fit a model and make it passive."""
    from passivity.expression.number import double
    from passivity.rational.evaluate import exact
    from passivity.sampled.check import check_samples
    from passivity.sampled.enforce import nearest

    asked.refuse("samples", "parameters", "delay", "within", "certificate", "sector", "supply")
    response = _read_samples(file, asked)
    verdict = check_samples(response, None if asked.error is None else double(exact(asked.error, "tolerance")))
    if asked.nearest and not asked.nearest.lower().endswith(wanted := (".json", f".s{response.ports}p")):
        raise InputError("--nearest", "not a file for these ports", " or ".join(wanted), f"'{asked.nearest}'")
    enforced = nearest(response) if asked.nearest else None
    told, lines = verdict.to_dict(), verdict.text_lines()
    if enforced is not None:
        told, lines = told | enforced.to_dict(), lines + enforced.text_lines()

    def save(path: str) -> None:
        if enforced is not None:
            model = path.lower().endswith(".json")
            write_text(json.dumps(told["model"], indent=2) + "\n" if model else enforced.response.touchstone(), path)

    plot = drawn("passivity.sampled.picture:draw_samples", verdict, enforced=enforced)
    return answer(verdict.status if enforced is None else enforced.status, lines, told, plot=plot, nearest=save)


def _read_samples(file: str, asked: Asked) -> "SampledResponse":
    from passivity.expression.number import double
    from passivity.rational.evaluate import exact
    from passivity.sampled.read import read_csv, read_touchstone
    from tline.scene.text_file import check_readable

    check_readable(file)
    if not file.lower().endswith(".csv"):
        asked.refuse("Touchstone files, which say so themselves", "kind", "z0")
        return read_touchstone(file)
    if asked.kind == "chain":
        raise InputError("--kind", "samples are of an impedance or a reflection", "pr or br", "'chain'")
    return read_csv(
        file, "S" if asked.kind == "br" else "Z", double(exact("50" if asked.z0 is None else asked.z0, "z0"))
    )


def scene(file: str, asked: Asked) -> Output:
    """Check every load, impedance and circuit of a scene; for active ones find how the scene's waves grow."""
    from passivity import is_positive_real
    from tline.interchange.any_file import read as read_any
    from tline.scene.rational import Impedance
    from tline.scene.touchstone import Touchstone
    from tline.solver.description.description import describe
    from tline.solver.description.elements import active_impedances, controlled_sources, laws_not_through_the_origin
    from tline.solver.description.passive import passive_circuits, taken_power
    from tline.solver.stability.growth import growth_sentence

    asked.refuse("scenes", "sector", "supply", "kind", "parameters", "z0", "delay", "within", "error", "nearest")
    read = read_any(file, confined=asked.confined)
    sources, active = controlled_sources(read), active_impedances(read)
    tested = {at: place(*at) for at, element in read.placed if isinstance(element, Impedance)}
    verdicts = {at: "refuted" if where in active else "proved" for at, where in tested.items()}
    suspect = {*active, *(place("links", name) for name in sources)}
    circuits = passive_circuits(read, suspect)
    whole = is_positive_real(taken_power(read, circuits))
    told: dict[str, Any] = {
        "status": whole.status.value,
        "statement": whole.statement,
        "proof": whole.proof,
        "loads": {name: verdicts.get(("loads", name), "proved") for name in read.loads},
        "links": {name: verdict for (part, name), verdict in verdicts.items() if part == "links"},
    }
    told["circuits"] = [_circuit_as_dict(circuit) for circuit in circuits]
    told["laws"] = laws_not_through_the_origin(read)
    what = "loads and impedances between nodes" if told["links"] else "loads"
    lines = [f"all {what} positive real: {'refuted' if active else 'proved'}"]
    lines += [f"  {place('links', name)}: a controlled source, which may feed waves" for name in sources]
    measured = {name: load for name, load in read.loads.items() if isinstance(load, Touchstone)}
    lines += [f"  {place('loads', name)}: proved, {load.model.why}" for name, load in measured.items()]
    laws = read.laws
    rest = sum(("loads", name) not in {*tested, *laws} and name not in measured for name in read.loads)
    if rest:
        lines.append(f"  {rest} with nothing but R, L, C, reservoirs and switches, passive by construction")
    lines += [f"  {where}: {verdicts[at]}" for at, where in tested.items()]
    lines += [f"  {where}: {sentence}" for where, sentence in told["laws"].items()]
    if through := len(laws) - len(told["laws"]):
        lines.append(f"  {through} that rise through the origin, or store, passive by construction")
    for circuit in circuits:
        lines += [f"  {_circuit_in_words(circuit)}: {circuit.status.value}", f"    because {circuit.why}"]
    if active or sources:
        told["growth"] = growth_sentence(describe(read))
        lines.append(f"  {told['growth']}")
    if whole.proof:
        lines.append(f"{whole.statement}: proved in {len(whole.proof['steps'])} steps")
    return answer(whole.status, lines, told, certificate=_certificate(whole))


def _circuit_as_dict(circuit: "CircuitVerdict") -> dict[str, Any]:
    told = {"nodes": circuit.nodes, "status": circuit.status.value, "why": circuit.why, "ports": circuit.ports}
    if circuit.scattering is None:
        return told
    rows = [[str(entry) for entry in row] for row in circuit.scattering.rows]
    return told | {"z0": str(circuit.z0), "scattering": rows}


def _circuit_in_words(circuit: "CircuitVerdict") -> str:
    nodes = first_of([*map(repr, circuit.nodes)], MOST_NODES)
    ports = f", {len(circuit.ports)} port{'s' * (len(circuit.ports) > 1)}" if circuit.scattering else ""
    return f"circuit at node{'s' * (len(circuit.nodes) > 1)} {nodes}{ports}"
