"""The compiled loops of methods that step in time, beside which the production method stands: arrays only.

Symbols: net a `Scattering` or a `Grid`, w Thévenin waves, x states of loads, u efforts, y flows;
drive (nodes, steps + 1) what sources give, seen the nodes whose efforts are recorded.
"""

import numpy as np

from tline.compiled import njit

TINY = 1e-150  # waves below are flushed to zero, as in the production kernel


@njit(error_model="numpy")
def scatter(net, drive, arriving, w, x, new, u, sent):
    """All nodes at one instant: w, x and u are brought up to it, and sent is what leaves the ends."""
    for k in range(len(net.row)):
        wave, r = drive[k], net.row[k]
        for j in range(net.first[k], net.first[k + 1]):
            wave += net.weight[j] * arriving[net.ends[j]]
        effort = wave
        if r >= 0:
            effort *= net.u_w[r]
            for i in range(len(new)):
                new[i] = net.x_before[r, i] * w[k] + net.x_now[r, i] * wave
                for j in range(len(new)):
                    new[i] += net.x_x[r, i, j] * x[r, j]
                effort += net.u_x[r, i] * new[i]
            x[r] = new
        w[k], u[k] = wave, effort
        for j in range(net.first[k], net.first[k + 1]):
            back = 2.0 * effort - arriving[net.ends[j]]
            sent[net.ends[j]] = 0.0 if abs(back) < TINY else back


@njit(error_model="numpy")
def advance_moc(net, late, taps, drive, seen, steps, record):
    """Lines by their histories: all that was sent from an end, after as many zeros as the longest delay takes."""
    ends, m, pad = 2 * len(late), net.x_x.shape[1], np.max(late) + 2
    history = np.zeros((ends, steps + 1 + pad))
    w, u, x, new = np.zeros(len(net.row)), np.zeros(len(net.row)), np.zeros((len(net.x_x), m)), np.zeros(m)
    arriving, sent = np.zeros(ends), np.zeros(ends)
    for k in range(steps + 1):
        for e in range(ends):
            at = k + pad - late[e // 2]
            arriving[e] = 0.0
            for j in range(4):
                if taps[e // 2, j] != 0.0:
                    arriving[e] += taps[e // 2, j] * history[e ^ 1, at + 1 - j]
        scatter(net, drive[:, k], arriving, w, x, new, u, sent)
        history[:, k + pad] = sent
        record[:, k] = u[seen]


@njit(error_model="numpy")
def advance_grid(net, ends, flows, drive, seen, steps, record):
    """Effort u and flow y on all points of all lines, begun on straight lines between the ends."""
    lines = len(net.reaches)
    most, effort = np.max(net.reaches) + 1, np.zeros(len(net.held))
    u, y, new_u, new_y = (
        np.zeros((lines, most)),
        np.zeros((lines, most)),
        np.zeros((lines, most)),
        np.zeros((lines, most)),
    )
    for j in range(lines):
        last = net.reaches[j]
        u[j, : last + 1] = ends[j, 0] + (ends[j, 1] - ends[j, 0]) / last * np.arange(last + 1)
        y[j, : last + 1] = flows[j]
    for k in range(len(net.held)):
        end = net.ends[net.first[k]]
        effort[k] = ends[end // 2, end % 2]
    record[:, 0] = effort[seen]
    for step in range(1, steps + 1):
        for j in range(lines):
            inside(u[j], y[j], new_u[j], new_y[j], net.reaches[j], net.z0[j], net.friction[j])
        for k in range(len(net.held)):
            flow, conductance = drive[k, step], net.conductance[k]
            for end in net.ends[net.first[k] : net.first[k + 1]]:
                w, z = arriving(net, end, u, y)
                flow, conductance = flow + w / z, conductance + 1 / z
            effort[k] = drive[k, step] if net.held[k] else flow / conductance
            for end in net.ends[net.first[k] : net.first[k + 1]]:
                w, z = arriving(net, end, u, y)
                j, place, sign = end // 2, net.reaches[end // 2] * (end % 2), 2.0 * (end % 2) - 1.0
                new_u[j, place], new_y[j, place] = effort[k], sign * (w - effort[k]) / z
        u, y, new_u, new_y = new_u, new_y, u, y
        record[:, step] = effort[seen]


@njit(error_model="numpy")
def arriving(net, end, u, y):
    """What comes to an end of a line: an effort behind an impedance."""
    j, place, sign = end // 2, (net.reaches[end // 2] - 1) * (end % 2) + 1 - end % 2, 2.0 * (end % 2) - 1.0
    before = y[j, place]
    return u[j, place] + sign * net.z0[j] * before, net.z0[j] + net.friction[j] * abs(before)


@njit(error_model="numpy")
def inside(u, y, new_u, new_y, reaches, z0, friction):
    """The points of a line between its ends."""
    for i in range(1, reaches):
        before, after = y[i - 1], y[i + 1]
        z_plus, z_minus = z0 + friction * abs(before), z0 + friction * abs(after)
        plus, minus = u[i - 1] + z0 * before, u[i + 1] - z0 * after
        flow = (plus - minus) / (z_plus + z_minus)
        new_y[i], new_u[i] = flow, plus - z_plus * flow


@njit(error_model="numpy")
def advance_cells(net, cells, courant, diffusion, drive, seen, steps, record):
    """The wave sent from each end on a grid of its own, whose last point arrives at the other end."""
    ends, m = 2 * len(cells), net.x_x.shape[1]
    a = np.zeros((ends, np.max(cells) + 1))
    w, u, x, new = np.zeros(len(net.row)), np.zeros(len(net.row)), np.zeros((len(net.x_x), m)), np.zeros(m)
    arriving, sent = np.zeros(ends), np.zeros(ends)
    for k in range(steps + 1):
        for e in range(ends if k else 0):
            last, C, d = cells[e // 2], courant[e // 2], diffusion[e // 2]
            before, arriving[e ^ 1] = a[e, 0], a[e, last] - C * (a[e, last] - a[e, last - 1])
            for i in range(1, last):
                now, after = a[e, i], a[e, i + 1]
                a[e, i] = now - C / 2 * (after - before) + d * (after - 2 * now + before)
                before = now
            a[e, last] = arriving[e ^ 1]
        scatter(net, drive[:, k], arriving, w, x, new, u, sent)
        a[:, 0] = sent
        record[:, k] = u[seen]


@njit(error_model="numpy")
def advance_fdtd(cells, courant, z0, at, held, x_x, x_i, drive, seen, steps, record):
    """Efforts u of each line at cell edges, flows y (times z0) between; x are the states of the nodes."""
    lines, nodes, m = len(cells), len(held), x_x.shape[1]
    u, y = np.zeros((lines, np.max(cells) + 1)), np.zeros((lines, np.max(cells)))
    x, new, effort, flow = np.zeros((nodes, m)), np.zeros(m), np.zeros(nodes), np.zeros(nodes)
    for k in range(steps + 1):
        flow[:] = (drive[:, k] + drive[:, max(k - 1, 0)]) / 2
        for j in range(lines if k else 0):
            n = cells[j]
            for i in range(n):
                y[j, i] -= courant[j] * (u[j, i + 1] - u[j, i])
            for i in range(1, n):
                u[j, i] -= courant[j] * (y[j, i] - y[j, i - 1])
            flow[at[2 * j]] -= y[j, 0] / z0[j]
            flow[at[2 * j + 1]] += y[j, n - 1] / z0[j]
        for node in range(nodes):
            if k:
                new[:] = x_i[node] * flow[node]
                for i in range(m):
                    for j in range(m):
                        new[i] += x_x[node, i, j] * x[node, j]
                x[node] = new
            effort[node] = drive[node, k] if held[node] else x[node, 0]
        for j in range(lines):
            u[j, 0], u[j, cells[j]] = effort[at[2 * j]], effort[at[2 * j + 1]]
        record[:, k] = effort[seen]
