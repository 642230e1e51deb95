"""Laws in a circuit: the waves into all of them, at all points that see each other, by one Newton method.

A law is a line end of no length. Into it goes the wave α = e + ρ i, out of it comes β = e - ρ i = R(α); the circuit
sends α = c + S β, where c is what nodes and states send. S cannot add energy if the circuit is passive, and R cannot
move two waves apart if the law is monotone. So the mean of α and c + S R(α) comes nearer to a solution, wherever there
is one (Krasnoselskii 1955); Newton's steps are taken where they do better.
"""

import numpy as np

from tline.solver.kernel.arithmetic import TINY, eliminate
from tline.solver.kernel.network import AIR, Run
from tline.solver.kernel.newton import CLOSE, FAINT, SPARE
from tline.unit import function, invoke, unit

TRIES, FREE = 1600, 100  # waves at which laws are asked; steps that need not do better than the last
# How to search, one after the other: length of every other step, and what restrains steps where waves answer to
# nothing, as between shut valves: a share of a power of the relative residual. The root of it is the surest.
SEARCHES = ((1.0, 0.1, 1.0), (0.5, 1.0, 0.7), (1.0, 1.0, 0.5))
SHORTER, SHORTEST = 0.25, 0.0625  # a part of Newton's step over the part tried before, and the least
GAIN = 0.1  # what a step must gain, for each part of it
DIFFERENCE = 1e-7  # of waves, for the slopes of stores


@function
def exchange_states(run, g, give):
    """Put the states of a group's stores aside, or give them back."""
    laws, states, kept = run.network.laws, run.state.load, run.work.circuit.kept
    for k in range(laws.first[g + 1] - laws.first[g]):
        e = laws.first[g] + k
        at, count = laws.state_at[e], 2 if laws.kind[e] == AIR else 1
        for i in range(count if at >= 0 else 0):
            if give:
                states[at + i] = kept[k, i]
            else:
                kept[k, i] = states[at + i]


@function
def ask(run, e, q, h, wave, o, flow):
    """Ask the law or the store of element e for its flows under q waves from place o on; a store moves its states."""
    laws, law, signal, k = run.network.laws, run.units.law[e], run.work.circuit.control, o // q
    z = laws.source_impedance[e]
    if laws.state_at[e] < 0:
        crossing = run.work.crossing
        for j in range(q):
            crossing.v[j], crossing.control[j] = wave[o + j], signal[k, j]
        invoke(law, (crossing, laws.at[e], q, z))
        for j in range(q):
            flow[o + j], run.work.circuit.slope[o + j] = crossing.flow[j], crossing.slope[j]
    else:
        store = run.work.store
        for j in range(q):
            store.v[j], store.control[j] = wave[o + j], signal[k, j]
        invoke(law, (store, laws.at[e], laws.state_at[e], h, z))
        for j in range(q):
            flow[o + j], run.work.circuit.drive[o + j] = store.flow[j], store.drive[j]


@function
def unbalance(run, g, q, h, step, at, k):
    """Flows under the waves `aimed`, and what these exceed c + S β by. Returns its square, its largest, and a scale."""
    laws, work, radau = run.network.laws, run.work.circuit, run.network.laws.tools.radau
    first, m = laws.first[g], laws.first[g + 1] - laws.first[g]
    wave, sent, flow, rest, size, width = work.aimed, work.sent, work.flow, work.rest, m * q, work.width[0]
    exchange_states(run, g, True)
    for law in range(m):
        ask(run, first + law, q, h, wave, law * q, flow)
        for j in range(q):
            sent[law * q + j] = wave[law * q + j] - 2.0 * laws.source_impedance[first + law] * flow[law * q + j]
    square, worst, scale = 0.0, 0.0, 0.0
    for a in range(size):
        place, z = at + (k * q + a) * width + k * q, laws.source_impedance[first + a // q]
        total = wave[a] - work.given[a] + sent[a]
        for b in range(size):
            total -= 2.0 * step[place + b] * sent[b]
        rest[a] = total
        square += total * total / z * (radau[q - 1, a % q] if q > 1 else 1.0)
        worst = max(worst, abs(total))
        scale = max(scale, abs(wave[a]), abs(work.given[a]), abs(sent[a]))
    return square, worst, scale


@function
def answered(run, g, q, h):
    """How flows answer to waves, law by law: `answer[a, j]` is the change of flow a with wave j of the same law."""
    laws, work = run.network.laws, run.work.circuit
    first, aimed, trial, answer = laws.first[g], work.aimed, work.trial, work.answer
    for law in range(laws.first[g + 1] - first):
        o = law * q
        if laws.state_at[first + law] < 0:
            for a in range(q):
                for j in range(q):
                    answer[o + a, j] = work.slope[o + a] if a == j else 0.0
            continue
        size = 0.0
        for j in range(q):
            size = max(size, abs(aimed[o + j]), abs(work.sent[o + j]))
        step = DIFFERENCE * max(size, TINY)
        for j in range(q):
            exchange_states(run, g, True)
            for a in range(q):
                trial[o + a] = aimed[o + a] + (step if a == j else 0.0)
            ask(run, first + law, q, h, trial, o, work.other)
            for a in range(q):
                answer[o + a, j] = (work.other[o + a] - work.flow[o + a]) / step


@function
def respond_to(run, g, q, step, at, k, restraint):
    """Solve the linear system of a Newton step, regularised by a restraint."""
    laws, work = run.network.laws, run.work.circuit
    first, size = laws.first[g], (laws.first[g + 1] - laws.first[g]) * q
    system, answer, width = work.system, work.answer, work.width[0]
    for a in range(size):
        place = at + (k * q + a) * width + k * q
        for b in range(size):
            o, z = b // q * q, laws.source_impedance[first + b // q]
            # 1 - S (1 - 2 ρ di/dα), with S = 2 step - 1
            total = (2.0 if a == b else 0.0) - 2.0 * step[place + b]
            for c in range(q):
                scattered = 2.0 * step[place + o + c] - (1.0 if a == o + c else 0.0)
                total += 2.0 * z * scattered * answer[o + c, b - o]
            system[a, b] = total
        system[a, a] += max(FAINT, restraint)
        system[a, size] = work.rest[a]
    eliminate(system, size)


@function
def solved(run, g, q, h, step, at, k, search):
    """Find the waves into the laws of a group. Returns whether it could.

    The first of Newton's steps are taken whatever they leave, for across kinks residuals rise before they vanish.
    """
    laws, work = run.network.laws, run.work.circuit
    size = (laws.first[g + 1] - laws.first[g]) * q
    aimed, start, turn = work.aimed, work.start, work.turn
    stride, share_of, power = SEARCHES[search]
    before, share, close, enough = 0.0, 0.0, False, False  # share of a Newton step that is tried; 0 for none
    steps, free, worst, scale = 0, False, np.inf, 0.0
    for _ in range(TRIES // q):  # stores are asked q times each
        now, worst, scale = unbalance(run, g, q, h, step, at, k)
        if enough or ((free or share == 0.0) and not np.isfinite(now)):
            return enough
        if free or share == 0.0 or now <= (1.0 - GAIN * share) ** 2 * before:
            if worst <= SPARE * scale:
                return True
            answered(run, g, q, h)
            respond_to(run, g, q, step, at, k, share_of * min(worst / scale, 1.0) ** power)
            for a in range(size):
                start[a], turn[a] = aimed[a], work.rest[a]
            before, close = now, worst <= CLOSE * scale
            free = steps < FREE and not close
            share = stride if free and steps % 2 == 1 else 1.0
            steps += 1
        else:
            share = share * SHORTER if share > SHORTEST else 0.0
            enough = close and share == 0.0
        for a in range(size):
            back = share * work.system[a, size] if share > 0.0 else 0.5 * turn[a]
            aimed[a] = start[a] - (0.0 if enough else back)
    return worst <= CLOSE * scale


@unit
def circuit(run: Run, g: int, n: int, h: float, own: int) -> int:
    """Turn the Thévenin waves of n samples at a group with laws into efforts, through its map over a slab of width h.

    The map is that of the network, or with `own` the one in the workspace. After it come the states.
    """
    network, laws, work, u, states = run.network, run.network.laws, run.work.circuit, run.work.u, run.state.load
    r, x, s = network.step_row[g], network.load_at[g], run.state.before.shape[1]
    k, m, count = network.group[g + 1] - network.group[g], laws.first[g + 1] - laws.first[g], network.step_states[r]
    q = s if network.step_whole[r] else np.int64(1)
    step, at, row = network.step, network.step_at[r], run.work.row
    if own != 0:
        step, at = run.work.map, np.int64(0)
    size, low, first = m * q, (k + m) * q, laws.first[g]
    width = low + count
    work.width[0] = width
    for block in range(n // q):
        for p in range(k):
            for i in range(q):
                row[p * q + i] = u[p * n + block * q + i]
        for i in range(count):
            row[low + i] = states[x + i]
        for a in range(size):
            place, total = at + (k * q + a) * width, 0.0
            for j in range(k * q):
                total += step[place + j] * row[j]
            for j in range(low, width):
                total += step[place + j] * row[j]
            work.given[a] = 2.0 * total
        for law in range(m):
            for i in range(q):
                work.control[law, i] = run.work.control[law, block * q + i]
        exchange_states(run, g, False)
        found = False
        for search in range(len(SEARCHES)):
            if not found:
                for a in range(size):
                    work.aimed[a] = work.waves[first * s + a] if search == 0 else work.given[a]
                found = solved(run, g, q, h, step, at, k, search)
        if not found:
            for a in range(size):
                work.waves[first * s + a] = 0.0
            for p in range(k):
                u[p * n + n - 1] = np.nan  # where it is looked for
            return 0
        for a in range(size):
            row[k * q + a], work.waves[first * s + a] = work.sent[a], work.aimed[a]
            stores = laws.state_at[first + a // q] >= 0
            run.work.into[a // q, block * q + a % q] = work.drive[a] if stores else work.aimed[a]
        for a in range(k * q):
            place, total = at + a * width, 0.0
            for j in range(width):
                total += step[place + j] * row[j]
            u[a // q * n + block * q + a % q] = total
        for i in range(count):
            place, total = at + (low + i) * width, 0.0
            for j in range(width):
                total += step[place + j] * row[j]
            states[x + i] = 0.0 if abs(total) < TINY else total
    return 0
