"""Responses of the laws of a group to waves: flows, residuals of the equations, and the system of a Newton step."""

import numpy as np

from tline.compiled.unit import function, invoke
from tline.solver.kernel.arithmetic import FAINT, TINY, eliminate, exchange_part
from tline.solver.kernel.network import MISSES

DIFFERENCE = 1e-7  # of waves, for the slopes of stores


@function
def exchange_states(run, g, give):
    """Put the states of a group's stores aside, or give them back."""
    laws, kept = run.network.laws, run.work.circuit.kept
    for e in range(laws.first[g], laws.first[g + 1]):
        exchange_part(run.state.load, laws.state_at[e], laws.states[e], kept[e - laws.first[g]], give)


@function
def keep_states(run, g, kept, give):
    """Put all states of a group aside, of its circuit, stores and openings, or give them back."""
    laws, states, n = run.network.laws, run.state.load, np.int64(0)
    if run.network.load_at[g] >= 0:
        n = run.network.step_states[run.network.step_row[g]]
        exchange_part(states, run.network.load_at[g], n, kept, give)
    for e in range(laws.first[g], laws.first[g + 1]):
        exchange_part(states, laws.state_at[e], laws.states[e], kept[n:], give)
        n += laws.states[e]
        if laws.governor_state[e] >= 0:
            exchange_part(states, laws.governor_state[e], np.int64(3), kept[n:], give)
            n += 3


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
def unbalance(run, g, q, h, step, at, k, mu):
    """Flows under the waves `aimed`, and F + μ (α - c). Returns its square, the largest of F and of it, and a scale."""
    laws, work, radau = run.network.laws, run.work.circuit, run.network.laws.tools.radau
    first, m = laws.first[g], laws.first[g + 1] - laws.first[g]
    wave, sent, flow, rest, size, width = work.aimed, work.sent, work.flow, work.rest, m * q, work.width[0]
    exchange_states(run, g, True)
    run.work.store.division[MISSES] = 0
    for law in range(m):
        ask(run, first + law, q, h, wave, law * q, flow)
        for j in range(q):
            sent[law * q + j] = wave[law * q + j] - 2.0 * laws.source_impedance[first + law] * flow[law * q + j]
    square, worst, off, scale = 0.0, 0.0, 0.0, 0.0
    for a in range(size):
        place, z = at + (k * q + a) * width + k * q, laws.source_impedance[first + a // q]
        moved = wave[a] - work.given[a]
        total = moved + sent[a]
        for b in range(size):
            total -= 2.0 * step[place + b] * sent[b]
        worst, rest[a] = max(worst, abs(total)), total + mu * moved
        square += rest[a] * rest[a] / z * (radau[q - 1, a % q] if q > 1 else 1.0)
        off = max(off, abs(rest[a]))
        scale = max(scale, abs(wave[a]), abs(work.given[a]), abs(sent[a]))
    return square, worst, off, scale


@function
def answered(run, g, q, h, stores):
    """Find the answers of flows to waves, by law: `answer[a, j]` is the change of flow a with wave j of the same law.

    The answers of stores, which take an evaluation for each point, may be kept as they are.
    """
    laws, work = run.network.laws, run.work.circuit
    first, aimed, trial, answer = laws.first[g], work.aimed, work.trial, work.answer
    for law in range(laws.first[g + 1] - first):
        o = law * q
        if laws.state_at[first + law] < 0:
            for a in range(q):
                for j in range(q):
                    answer[o + a, j] = work.slope[o + a] if a == j else 0.0
            continue
        if not stores:
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
