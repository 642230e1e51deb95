"""The smooth laws by Rodas5P: steps that depend neither on samples nor on the end, and the instants of events.

If asked for, steps are Taylor series where the contact is soft: explicit, so bounded by the rate σ0·|v|/g of slip.

A contact slides from the instant at which its friction, without the viscous part, comes within 1 % of its steady value
in the direction of the motion, which is its break-away, until the velocity vanishes, which is its stop.
"""

from math import copysign, inf, isfinite

from friction.kernel import law as laws, series
from friction.kernel.law import applied, friction, gap, note, piece, put, steady
from friction.kernel.rodas import STAGES, TERMS, continue_into, inside, rodas
from friction.kernel.structures import EVENTS, REFUSED, RUN, STEPS, STRIDE
from tline.compiled.unit import function

ORDER = 5  # of Rodas5P
STABLE, WORTH, SETTLED = 5.0, 3.0, 10  # slip within an explicit step, implicit steps that it costs, and steps in doubt
MOST_TRIES = 9  # to land on a reversal
EARLY = 2e-3  # first step at a tolerance of 1, of the time scale of the contact
SMALLEST_MAGNITUDE = 1e-300  # of a magnitude


@function
def period_of(law, mass):
    """Time scale of the contact."""
    return mass * law.epsilon / law.f_c if law.kind == laws.TANH else (mass / law.sigma0) ** 0.5


@function
def rosenbrock(law, bench, tol, parts, budget, compared, which):
    """One run with its own steps, which land on reversals, where |v| has a kink; each piece of the force takes at least
    `parts` steps.

    Errors are weighed with the magnitudes of the run before; of the first run (parts = 1), with its own so far. Keeps
    samples, the largest magnitude of each column, in that of time the largest error of a step, and in that of the mode
    the error missed at reversals; the counts hold steps made and refused, and events. Returns the status.
    """
    y, new, peaks, counts = compared.y, compared.new, compared.peaks, compared.counts
    explicit, since, first = compared.dense.shape[0] > TERMS, 0, parts == 1
    sizes = peaks if first else compared.weights
    begin(compared, bench.start, first, which)
    t, h, number, row, check, mode = 0.0, EARLY * tol**0.2 * period_of(law, bench.mass), 0, 0, 0, 0
    push = piece(bench.drive, 0)
    if gap(law, y[1], y[2]) >= 0.0:
        mode = int(copysign(1.0, y[1]))
    margin, pull = held_back(law, mode, y[1], y[2]), forces(law, push, t, y)
    while t <= bench.t_end:
        if counts[STEPS] + counts[REFUSED] >= budget:
            return laws.BUDGET
        largest(peaks, y, pull)
        explicit, since, longest = chosen(law, y[1], h, explicit, since, compared.dense)
        most = min(h, longest, (push.end - push.start) / parts)
        last = most >= 0.999 * (push.end - t)
        step = push.end - t if last else min(most, 0.5 * (push.end - t))
        step, error, tries, after = attempt(law, push, bench.mass, t, pull, step, tol, sizes, first, compared, explicit)
        counts[REFUSED] += tries
        last = last and tries == 0
        if not error <= 1.0 or not (last or tries > 0):
            order = series.TERMS - 1 if explicit else ORDER
            h = step * (min(6.0, max(0.1, 0.9 * (error + 1e-12) ** (-1.0 / order))) if isfinite(error) else 0.1)
        if not error <= 1.0:
            if t + step == t:
                return laws.STALLED
            counts[REFUSED] += 1
            continue
        counts[STEPS] += 1
        peaks[laws.T] = max(peaks[laws.T], error * tol)
        before, margin = margin, held_back(law, mode, new[1], new[2])
        until = push.end if last else t + step
        crossed = not margin > abs(margin - before)
        if crossed or due(bench.times, row, until) or (parts > 1 and due(compared.instants, check, until)):
            if not explicit:
                continue_into(y, new, compared.u, compared.dense)
            while parts > 1 and due(compared.instants, check, until):
                at = compared.instants[check]
                keep(law, push, t, step, mode, compared.dense, at, compared.checks[which][check])
                check += 1
            row, mode = watch(law, bench, push, t, step, mode, row, compared)
            margin = held_back(law, mode, new[1], new[2])
        t, pull = until, after
        for j in range(5):
            y[j] = new[j]
        if first and t <= bench.t_end:
            check = mark(compared, check, t, mode, pull)
        if last:
            number += 1
            push = piece(bench.drive, number)
            pull = forces(law, push, t, y)
    return laws.DONE


@function
def chosen(law, v, h, explicit, since, dense):
    """Whether the next step is explicit, how long that has been in doubt, and how long the step may be.

    Slip bounds explicit steps. If it does so ten times on end, where accuracy would allow a longer one, implicit steps
    are made; after ten, which find their length, explicit ones if these may be longer by the ratio of their costs.
    """
    if dense.shape[0] == TERMS:
        return False, 0, inf
    longest = STABLE * steady(law, v)[0] / (law.sigma0 * abs(v) + SMALLEST_MAGNITUDE)
    if not explicit:
        again = since >= SETTLED and longest > WORTH * h
        return again, (0 if again else since + 1), (longest if again else inf)
    since = since + 1 if h > longest else 0
    if since < SETTLED:
        return True, since, longest
    for k in range(TERMS, dense.shape[0]):
        for j in range(dense.shape[1]):
            dense[k, j] = 0.0
    return False, 0, inf


@function
def begin(compared, start, first, which):
    """The state at the start; nothing is counted or kept yet."""
    counts, y = compared.counts, compared.y
    counts[STEPS], counts[REFUSED], counts[EVENTS], counts[RUN] = 0, 0, 0, which
    for j in range(y.size):
        y[j] = start[j]
    for column in range(compared.peaks.size):
        compared.peaks[column] = 0.0
    if first:
        counts[STRIDE] = 1
        for i in range(compared.instants.size):
            compared.instants[i] = inf


@function
def due(times, row, until):
    """Whether the next of the times is reached."""
    return row < times.size and times[row] <= until


@function
def mark(compared, check, t, mode, pull):
    """Keep the end of a step of the first run, for later ones to be compared with; the number of the next.

    When they are too many, every second one goes.
    """
    instants, counts, y = compared.instants, compared.counts, compared.y
    rows = compared.checks[counts[RUN]]
    if counts[STEPS] % counts[STRIDE] != 0:
        return check
    if check == instants.size:
        counts[STRIDE], check = 2 * counts[STRIDE], check // 2
        for i in range(instants.size):
            instants[i] = instants[2 * i + 1] if i < check else inf
            for column in range(rows.shape[1]):
                rows[i, column] = rows[2 * i + 1, column] if i < check else 0.0
        return check
    instants[check] = t
    note(rows[check], t, y, pull[0], pull[2], mode)
    return check + 1


@function
def forces(law, push, t, y):
    """Applied force, its partial derivative in time, and friction."""
    f_a, f_t = applied(push, t, y[0])
    return f_a, f_t, friction(law, y[1], y[2], f_a)[0]


@function
def largest(peaks, y, pull):
    """Note the largest magnitudes so far."""
    for j, column in ((0, laws.X), (1, laws.V), (2, laws.Z), (3, laws.WA), (4, laws.WF)):
        peaks[column] = max(peaks[column], abs(y[j]))
    peaks[laws.FA], peaks[laws.FF] = max(peaks[laws.FA], abs(pull[0])), max(peaks[laws.FF], abs(pull[2]))


@function
def attempt(law, push, mass, t, pull, step, tol, sizes, first, compared, explicit):
    """A step of at most that length into `new`; the step, its error over the tolerance, tries before it, and the forces
    at its end.

    With |v| read as s·v, the error of a step over a reversal is ∫|v|dt on the wrong side of zero; where that counts,
    the step ends at the reversal instead. Otherwise the error is added up in the largest magnitude of the mode.
    """
    y, new, u, dense = compared.y, compared.new, compared.u, compared.dense
    rise, s, begun, tries = (pull[0] - pull[2]) / mass, copysign(1.0, y[1]), 0.0, 0
    way = y[1] ** 2 / (2.0 * abs(rise) + SMALLEST_MAGNITUDE)
    if harm(law, mass, sizes, y[2], way) <= 0.05 * tol:  # about to change its sign
        s = copysign(1.0, rise if rise != 0.0 else pull[1])
        begun = way if s * y[1] < 0.0 else 0.0
    while True:
        if explicit:
            series.taylor(law, push, mass, t, s, step, compared)
        else:
            rodas(law, push, mass, t, s, step, compared)
        error = missed_by(mass, sizes, first, new, u[STAGES - 1]) / tol
        if not error <= 1.0:
            return step, error, tries, pull
        after, missed = forces(law, push, t + step, new), begun
        if law.kind != laws.BRISTLE or tries == MOST_TRIES:
            break
        back = s * new[1] < 0.0
        dips = not back and s * rise < 0.0 and s * (after[0] - after[2]) > 0.0
        if not back and not dips:
            break
        if not explicit:
            continue_into(y, new, u, dense)
        theta = 1.0 if back else lowest(dense, s)
        v = s * inside(dense, 1, theta)
        missed = max(0.0, -v * step * (v / (v - abs(y[1]) - SMALLEST_MAGNITUDE) if back else 1.0))
        if harm(law, mass, sizes, max(abs(y[2]), abs(new[2])), missed) <= 0.1 * tol:
            break
        begins = lowest(dense, -s) if s * y[1] <= 0.0 else 0.0
        if s * inside(dense, 1, begins) > 0.0:
            step *= crossing(law, dense, int(s), begins, theta)
        else:
            s = -s
        tries += 1
    compared.peaks[laws.MODE] += harm(law, mass, sizes, y[2], missed)
    return step, error, tries, after


@function
def harm(law, mass, sizes, z, way):
    """Relative error that a way run with the wrong sign leaves in the deflection, and in the speed that it gives."""
    if law.kind != laws.BRISTLE:
        return 0.0
    bend = abs(z) + way
    wrong, rate = 2.0 * law.sigma0 * bend / law.f_c * way, (law.sigma0 / mass) ** 0.5
    return wrong * max(
        1.0 / max(sizes[laws.Z], bend, SMALLEST_MAGNITUDE), rate / max(sizes[laws.V], bend * rate, SMALLEST_MAGNITUDE)
    )


@function
def missed_by(mass, sizes, first, new, error):
    """Error of a step relative to the magnitudes of the motion; in a first run, of its energy for the works."""
    energy = max(
        sizes[laws.WA], sizes[laws.WF], abs(new[3]), abs(new[4]), 0.5 * mass * max(sizes[laws.V], abs(new[1])) ** 2
    )
    worst = 0.0
    for j, column in ((0, laws.X), (1, laws.V), (2, laws.Z), (3, laws.WA), (4, laws.WF)):
        size = energy if first and j >= 3 else max(sizes[column], abs(new[j]))
        worst = max(worst, abs(error[j]) / (size + SMALLEST_MAGNITUDE))
    return worst


@function
def lowest(dense, s):
    """Where within a step s·v, which falls at first, is least."""
    low, high = 0.0, 1.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        rate = 0.0
        for k in range(dense.shape[0] - 1, 0, -1):
            rate = rate * middle + k * dense[k, 1]
        if s * rate < 0.0:
            low = middle
        else:
            high = middle
    return high


@function
def held_back(law, mode, v, z):
    """Positive while the mode lasts."""
    return mode * v if mode != 0 else -gap(law, v, z)


@function
def guard(law, dense, mode, theta):
    """Evaluate `held_back` within a step."""
    return held_back(law, mode, inside(dense, 1, theta), inside(dense, 2, theta))


@function
def crossing(law, dense, mode, low, high):
    """Where within a step the sign of the guard changes: regula falsi that halves when it does not."""
    f_low, f_high = guard(law, dense, mode, low), guard(law, dense, mode, high)
    for n in range(80):
        middle = 0.5 * (low + high)
        if n % 3 and f_low != f_high:
            middle = min(max(low - f_low * (high - low) / (f_high - f_low), low), high)
        f = guard(law, dense, mode, middle)
        if (f > 0.0) == (f_low > 0.0):
            low, f_low = middle, f
        else:
            high, f_high = middle, f
        if high - low <= 1e-15 or f == 0.0:
            break
    return high


@function
def watch(law, bench, push, t, step, mode, row, compared):
    """Samples and events of an accepted step; the next sample, and the mode at its end."""
    dense, times, counts = compared.dense, bench.times, compared.counts
    record, events = compared.records[counts[RUN]], compared.events[counts[RUN]]
    theta = 0.0
    while True:
        root = 2.0
        for k in (0.5, 1.0):
            if k > theta and not guard(law, dense, mode, k) > 0.0:
                root = crossing(law, dense, mode, theta, k)
                break
        until = t + min(root, 1.0) * step
        while row < times.size and times[row] <= until:
            keep(law, push, t, step, mode, dense, times[row], record[row])
            row += 1
        if root > 1.0 or until > bench.t_end:
            return row, mode
        before, theta = mode, root
        mode = int(copysign(1.0, inside(dense, 1, root))) if mode == 0 else 0
        counts[EVENTS] = put(events, counts[EVENTS], before, mode, until, inside(dense, 0, root))


@function
def keep(law, push, t, step, mode, dense, at, record):
    """A sample within a step."""
    theta = min((at - t) / step, 1.0)
    x, v, z = inside(dense, 0, theta), inside(dense, 1, theta), inside(dense, 2, theta)
    f_a, works = applied(push, at, x)[0], (inside(dense, 3, theta), inside(dense, 4, theta))
    note(record, at, (x, v, z, works[0], works[1]), f_a, friction(law, v, z, f_a)[0], mode)
