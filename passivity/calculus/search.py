"""Where a property may fail: searched in floats, over a grid, at poles, along the axis."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction
from itertools import islice, pairwise

from flint import acb, ctx

from passivity.ball import near
from passivity.budget import spend
from passivity.calculus.graph import Value
from passivity.calculus.question import Question
from passivity.calculus.rewrite import Line
from passivity.calculus.values import Array, Spot, in_balls, in_floats, needed
from passivity.expression.number import double
from passivity.status import Kind
from passivity.verdict import Witness

_SIZES, _ANGLES = 240, 16  # of a logarithmic grid
_AXIS = 4000
_COARSE = 40, (0.0, 0.8, 1.3, 1.5, 1.56, 1.5705), 300  # radii, angles, points near the axis of the first look
_TURNS = 1e4  # of the shortest delay, after which loads are as at infinite frequency, some more of which are looked at
_VISIBLE = 1e-12  # by how much floats must see the property fail
_FAR = 100  # decades beyond all scales, on the real axis
_POLISHED = 12  # peaks along the axis, and suspects, that are looked at
_NEWTON = 16  # steps of Newton's method to poles
_LINES, _KEPT, _ROOTS, _AIMS = 2, 8, 3, 18  # of loads, of places where they are -z0, of steps to where that shows
_TURNS_UP = 48  # quarters of a turn of a delay up to which such places are looked for
_BITS = 160, 1024, 4096, 16384  # of precision
_LENGTHS = 24, 53, 120, 240, 480, 960, 1920, 3840, 7680, 15360  # of a witness, in bits
_SURE = 1.5  # bits of precision for each neper that is lost on the way of a wave to the input and back
_Term = tuple[int, float, tuple[tuple[str, int], ...]]
_DISTANCES, _NEARER = (4, 8, 16, 32), (64, 256, 1024, 4096)  # binary, in parts of the modulus
_BESIDE = *_DISTANCES, 64, 128  # of the frequency
_RADII = (16, 64, 512, 2048)  # of discs, likewise
_EXPONENTS = 16, 2**12, 2**40, 2**1400  # of the size of a part near its zero
_USUAL = 1e-2, 1e2  # moduli of zeros of which the coefficients do not tell, as of sqrt(s) - 2
_DIRECTIONS = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1))


class Scales:
    """Terms in s and times, the same for all values of the names, whose balances give frequencies to search."""

    def __init__(self, question: Question):
        self.graph, self.order = question.graph, needed(question.graph, question.value[1])
        self.times: set[_Term] = set()
        self.sums: list[list[_Term]] = []
        for n in self.order:
            kind, parts = self.graph.nodes[n]
            if kind in ("exp", "tanh", "cosh", "line"):
                c, m = parts[1] if kind == "line" else parts[0]
                self.times |= {term for k, x in self.graph.terms(m, c).items() if (term := self._term(x, k))[0] == 1}
            elif kind == "sum":
                self.sums.append([self._term(c, m) for c, m in parts])

    def _term(self, c: Fraction, n: int) -> _Term:
        """The power of s in a term, the logarithm of its coefficient, and the names in it."""
        powers, nodes = self.graph.powers(n), self.graph.nodes
        names = tuple((nodes[m][1][0], e) for m, e in powers.items() if nodes[m][0] == "name")
        return powers.get(self.graph.s[1], 0), math.log(abs(c.numerator)) - math.log(c.denominator), names

    def periods(self, names: Mapping[str, float]) -> list[float]:
        """The lengths of time in arguments of functions: 1/T of exp(-T s)."""
        return sorted({_exp(-_size(term, names)) for term in self.times})[:8]

    def ratios(self, names: Mapping[str, float]) -> list[float]:
        """Where neighbouring powers of s in a sum are of one size."""
        found = []
        for terms in self.sums:
            known = sorted((term[0], _size(term, names)) for term in terms)
            found += [_exp((a - b) / (j - i)) for (i, a), (j, b) in pairwise(known) if i != j and math.isfinite(a - b)]
        return found


def _size(term: _Term, names: Mapping[str, float]) -> float:
    """Return the logarithm of the magnitude of the coefficient of a term in s."""
    _, size, powers = term
    return size + sum(e * math.log(abs(names[name])) for name, e in powers if names[name])


class Search:
    """The search with given values of the names."""

    def __init__(self, question: Question, names: Mapping[str, Fraction], scales: "Scales | None" = None):
        self.question, self.names, self.scales = question, dict(names), scales or Scales(question)
        self.floats = {name: double(x) for name, x in names.items()}
        self.periods = self.scales.periods(self.floats)
        sizes = self.periods + self.scales.ratios(self.floats) or [1.0]
        self.closing: dict[int, int] = {}  # the line of which a node is about z0 + load
        self.low, self.high = min(sizes) * 1e-6, max(sizes) * 1e6

    def glance(self, count: int = _COARSE[0], angles: Array = _COARSE[1]) -> Witness | None:
        """A witness among points of a grid, of the axis, and of both axes far out; the nearest to its middle first."""
        import numpy as np

        fine = _COARSE[2]
        radii = np.geomspace(self.low * 1e3, self.high / 1e3, count)
        grid = (radii[:, None] * np.exp(1j * np.array(angles))).ravel()
        far = np.logspace(math.log10(self.high), min(math.log10(self.high) + _FAR, 300), _FAR // 5)
        turns = _TURNS * max(self.periods, default=0.0) * np.linspace(1, 1.005, fine)[: fine * bool(self.periods)]
        axis = np.concatenate([np.geomspace(self.low * 1e3, self.high / 1e3, fine) * (1e-6 + 1j), turns * (1e-13 + 1j)])
        s = np.concatenate([grid, axis, far])
        wrong, there = self.badness(s), self.values(radii + 0j)
        suspects = [s[k] for k in np.argsort(-wrong)[:6] if wrong[k] > _VISIBLE]
        clear = s[wrong > min(max(wrong.max() / 2, _VISIBLE), 1)]
        unreal = radii[np.abs(there.imag) > 1e-6 * np.abs(there)]
        middle = math.sqrt(self.low) * math.sqrt(self.high)
        for point in (*_nearest(clear, middle), *suspects, *_nearest(unreal, middle)):
            for bits in (3, 6, 14, 40):
                if found := self.check(_short(float(point.real), bits), _short(float(point.imag), bits)):
                    return found
        return None

    def hunt(self) -> Witness | None:
        """A witness where Re Z < 0, |H| > 1, or where the value at a real s is not real; None if none was found."""
        import numpy as np

        with np.errstate(all="ignore"):
            suspects = islice(self._suspects(), _POLISHED)
            roots = [(suspect, place) for suspect in suspects for place in self._located(suspect)]
            if found := next(filter(None, (self.around(place) for _, place in roots)), None):
                return found
            if found := self.glance(_SIZES, np.linspace(0, np.pi / 2, _ANGLES, endpoint=False)):
                return found
            for w in (float(w) for tilt in (0.0, 1e-6) for w in self._refined(tilt)[:4]):
                if found := self.beside(w):
                    return found
        zeros = []
        for suspect, place in sorted(
            roots, key=lambda root: abs(float(root[1].arg()))
        ):  # digits tell those near the axis
            zeros.append((suspect, self._polished(suspect, place)))
            if found := self.around(zeros[-1][1], _NEARER, 1 if self.question.kind is Kind.BR else None):
                return found
        return next(filter(None, (self._close(*each) for each in zeros)), None)

    def _located(self, value: Value) -> list[acb]:
        """Some zeros of a part in Re s > 0."""
        starts = (self._zeros(value, self._spread(*ends))[:_ROOTS] for ends in ((), _USUAL))
        return [acb(root.real, root.imag) for roots in starts for root in roots]

    def _polished(self, value: Value, root: acb) -> acb:
        """A zero of a part in as many digits as points nearest to it need."""
        with ctx.workprec(2 * _NEARER[-1]):
            for place in _approaching(lambda s: in_balls(self.question.graph, [value], s, self.names)[0], root):
                root = place if place.real > 0 else root
        return root

    def _close(self, value: Value, root: acb) -> Witness | None:
        """The whole may fail where a part is small enough near its zero, whatever else is small there."""
        size = _short(max(near(root.real), near(root.imag), key=abs), 1)
        node = ~self.closing[value[1]] if value[1] in self.closing else value[1]
        for radius in (size / 2**bits for bits in _RADII):
            re, im = (round(8 * x / radius) * radius / 8 for x in (near(root.real), near(root.imag)))
            for exponent in _EXPONENTS:
                for turn in range(1 if self.question.kind is Kind.BR else 4):
                    if found := self.question.fails(re, im, self.names, Spot(radius, node, exponent, turn)):
                        return found
        return None

    def behind(self, lines: list[tuple[int, int, Line]]) -> Witness | None:
        """A witness where the load of a line is near -z0, in Re s > 0, for the first lines of some, or for the last.

        The point is solved for at which the whole has a value impossible for a passive one, in as many digits as it
        takes, however weakly the input depends on that load. The point is followed from line to line.
        """
        graph, order = self.question.graph, set(self.scales.order)
        parts = {
            n: b for n, *_ in lines for b in graph.powers(n) if b in order and graph.nodes[b][0] in ("sum", "line")
        }
        lines = [each for each in lines if each[0] in parts]
        starts = (self._spread(), self._ladder()) if lines else ()
        ways = [(bits, places, first) for bits in _BITS for places in starts for first in range(_LINES)]
        for bits, places, first in ways:
            for k, (n, sign, line) in enumerate(lines[first:], first):
                places = self._zeros(graph.sum([line[2], line[0]]), places)
                if not len(places):
                    break
                if _LINES <= k < len(lines) - 1:
                    continue
                lost = self.values(places, graph.sum(along for _, _, (_, along, _) in lines[k:])).real
                for root in places[_SURE * 2 * lost < bits][:_ROOTS]:
                    if found := self._aimed(n, parts[n], sign, line, root, bits):
                        return found
        return None

    def _spread(self, low: float = 0.0, high: float = 0.0) -> Array:
        """Places in the right half plane on a logarithmic grid."""
        import numpy as np

        radii = np.geomspace(low or self.low * 1e5, high or self.high / 1e4, 30)
        return (radii[:, None] * np.exp(1j * np.array([0, 0.5, 0.9, 1.2, 1.4, 1.5]))).ravel()

    def _ladder(self) -> Array:
        """Places beside the axis at many turns of each delay."""
        import numpy as np

        turns = np.array([0.02, 0.1, 0.4])[:, None] + 0.5j * np.pi * np.arange(1, _TURNS_UP)
        return np.concatenate([np.zeros(0, complex), *((x * turns).ravel() for x in self.periods[:4])])

    def _zeros(self, value: Value, s: Array) -> Array:
        """Zeros of a part in Re s > 0, by Newton's method from some places; nearest to the axis first."""
        import numpy as np

        order, ended = needed(self.question.graph, value[1]), []
        with np.errstate(all="ignore"):
            for _ in range(_NEWTON if len(s) else 0):
                both = np.stack([s, s + 1e-6 * np.abs(s)])
                f, after = in_floats(self.question.graph, value, both, self.floats, order)
                step = f / (after - f) * (both[1] - s)
                s = s - step * np.minimum(1, np.abs(s) / np.abs(step))
                there = np.abs(step) < 1e-6 * np.abs(s)
                ended += s[there & (s.real > 0)].tolist()
                s = s[~there & np.isfinite(s)]
                if not len(s):
                    break
        found: list[complex] = []
        for root in sorted((complex(x.real, abs(x.imag)) for x in ended), key=lambda x: x.real):
            if all(abs(root - other) > 1e-4 * abs(root) for other in found):
                found.append(root)
        return np.array(found[:_KEPT])

    def _aimed(self, n: int, part: int, sign: int, line: Line, root: complex, bits: int) -> Witness | None:
        """A witness near a point, where the load of a line is such that the whole fails, by secants in balls.

        The whole is (a v + b)/(c v + d) of the load v, known from three of these; the line times a sign is node n, and
        a part of n, on which the whole depends, carries its value.
        """
        graph, value = self.question.graph, self.question.value
        e = graph.powers(n)[part]
        rest = graph.product([(Fraction(sign), n), (Fraction(1), part)], [1, -e])
        parts, whole = [*line, rest], needed(graph, value[1], known=[part])
        before = needed(graph, *(m for _, m in parts))

        def excess(s: acb) -> acb:
            z0, through, load, over = in_balls(graph, parts, s, self.names, order=before)
            wave = through.tanh()
            v1, v2, v3 = z0, 2 * z0, z0 * acb(0, 1)
            seen = [z0 * (v + z0 * wave) / (z0 + v * wave) / over for v in (v1, v2, v3)]
            w1, w2, w3 = (in_balls(graph, [value], s, self.names, {part: w**e}, whole)[0] for w in seen)
            goal = acb(2) if self.question.kind is Kind.BR else -w1
            ratio = (goal - w1) * (w2 - w3) / ((goal - w3) * (w2 - w1))
            return load - (v1 * (v2 - v3) - ratio * v3 * (v2 - v1)) / (v2 - v3 - ratio * (v2 - v1))

        spend(_AIMS * len(self.scales.order) * (3_000 + 10 * bits), "a pole")
        first, place = abs(root) / 2, None
        with ctx.workprec(bits):
            for place in _approaching(excess, acb(root.real, root.imag)):
                if not abs(place - acb(root.real, root.imag)) < first or not place.real > 0:
                    return None
                if found := self.check(_short(near(place.real), _LENGTHS[1]), _short(near(place.imag), _LENGTHS[1])):
                    return self.rounded(place) or found
        return place and self.rounded(place)

    def beside(self, w: float) -> Witness | None:
        """A witness near a frequency on the axis."""
        return self.around(acb(0, w), _BESIDE, 1)

    def around(self, root: acb, distances: Iterable[int] = _DISTANCES, directions: int | None = None) -> Witness | None:
        """A witness ever nearer to a pole or a zero in Re s >= 0, in some directions, or in all."""
        re, im = near(root.real), near(root.imag)
        for unit in (_short(max(re, im, key=abs) or Fraction(1), 1) / 2**distance for distance in distances):
            for x, y in _DIRECTIONS[:directions]:
                if found := self.check(round(re / unit + x) * unit, round(im / unit + y) * unit):
                    return found
        return None

    def lowest(self) -> float | None:
        """Lowest sampled frequency where Re Z(jw) is least, or |H(jw)| largest; None without samples."""
        import numpy as np

        with np.errstate(all="ignore"):
            w = self._refined(0.0)
            value = self.badness(1j * w, relative=False)
            least = w[value > value.max() - 1e-9 * (1 + abs(value.max()))] if len(w) else w
        return float(least.min()) if len(least) else None

    def rounded(self, place: acb) -> Witness | None:
        """Round a point to a witness with few digits; None if no rounding is a witness."""
        shorter = ([_short(near(part), bits) for part in (place.real, place.imag)] for bits in _LENGTHS)
        return next(filter(None, (self.check(*point) for point in shorter)), None)

    def check(self, re: Fraction, im: Fraction) -> Witness | None:
        """Return the point as a witness, if the property fails there."""
        return self.question.fails(re, im, self.names)

    def values(self, s: Array, value: Value | None = None) -> Array:
        """Values of the function, or of a part of it, at points."""
        order = None if value else self.scales.order
        return in_floats(self.question.graph, value or self.question.value, s, self.floats, order)

    def badness(self, s: Array, relative: bool = True) -> Array:
        """Violation of the property at points: |H| - 1, or -Re Z, by default relative to |Z|."""
        import numpy as np

        f = self.values(s)
        size = np.abs(f)
        with np.errstate(all="ignore"):
            found = size - 1 if self.question.kind is Kind.BR else -f.real / (size if relative else 1)
        return np.where(np.isfinite(found), found, -np.inf)

    def _suspects(self) -> Iterator[Value]:
        """Functions whose zeros in Re s > 0 may be poles of the whole, or zeros of an impedance."""
        graph, root = self.question.graph, self.question.value
        yield graph.inverse(root)
        if self.question.kind is not Kind.BR:
            yield root
        for n in reversed(self.scales.order):
            kind, parts = graph.nodes[n]
            if kind == "mul":
                below = [m for m, e in parts if e < 0 and graph.nodes[m][0] in ("sum", "tanh", "cosh", "line")]
                yield from ((Fraction(1), m) for m in below)
            elif kind == "tanh" and n != root[1]:
                yield graph.inverse((Fraction(1), n))
            elif kind == "line":  # A + Z tanh B, which is 0 at its poles; A + Z, where the reflection has one
                z0, through, load = parts
                self.closing[(closing := graph.sum([load, z0]))[1]] = n
                yield closing
                yield graph.sum([z0, graph.product([load, graph.function("tanh", through)])])

    def _refined(self, tilt: float) -> Array:
        """Frequencies of the worst points near the axis, after shrinking a grid around each."""
        import numpy as np

        turns = (np.linspace(0, 50 * x, _AXIS // 4)[1:] for x in self.periods)  # some 8 turns of each delay
        w = np.unique(np.concatenate([np.geomspace(self.low, self.high, _AXIS), *turns]))
        value = self.badness((tilt + 1j) * w, relative=False)
        peaks = np.flatnonzero((value >= np.roll(value, 1)) & (value >= np.roll(value, -1)) & np.isfinite(value))
        peaks = np.union1d(peaks[np.argsort(-value[peaks])][:_POLISHED], peaks[:_POLISHED])
        left, right = w[np.maximum(peaks - 1, 0)], w[np.minimum(peaks + 1, len(w) - 1)]
        for _ in range(12):
            grid = np.linspace(left, right, 17, axis=-1)
            best = np.argmax(self.badness((tilt + 1j) * grid, relative=False), axis=-1)
            rows = np.arange(len(grid))
            left, right = grid[rows, np.maximum(best - 1, 0)], grid[rows, np.minimum(best + 1, 16)]
        middle = (left + right) / 2
        return middle[np.argsort(-self.badness((tilt + 1j) * middle, relative=False))]


def _approaching(function: Callable[[acb], acb], s: acb) -> Iterator[acb]:
    """Places ever nearer to a zero, by secants, as near as the precision allows."""
    last = s + abs(s) / 2**30
    before = function(last)
    for _ in range(_AIMS):
        f = function(s)
        step = f * (s - last) / (f - before)
        if f.contains(0) or not step.is_finite():
            return
        last, before, s = s, f, acb((s - step).real.mid(), (s - step).imag.mid())
        yield s


def _exp(x: float) -> float:
    return math.exp(max(-500.0, min(500.0, x)))


def _nearest(s: Array, size: float) -> Array:
    """The three points whose modulus is nearest to a size."""
    import numpy as np

    return s[np.argsort(np.abs(np.log(np.abs(s) / size)))[:3]]


def _short(x: float | Fraction, bits: int) -> Fraction:
    """Round a number to `bits` binary digits."""
    x = Fraction(x)
    grid = Fraction(2) ** (x.numerator.bit_length() - x.denominator.bit_length() + 1 - bits)
    return round(x / grid) * grid
