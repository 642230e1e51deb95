"""One step of Rodas5P on the friction laws that are smooth, with its dense output."""

import numpy as np

from friction.kernel.law import applied, jacobian, respond
from tline.compiled.unit import function

# Rodas5P, Steinebach, BIT Numerical Mathematics 63 (2023) 27, doi:10.1007/s10543-023-00967-x: order 5, L-stable, and
# no loss of order on z, which follows the stiff balance of bristles
GAMMA, STAGES = 0.21193756319429014, 8
TERMS = 5  # of the dense output
ALPHA = np.array([0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0])
D = np.array([GAMMA, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0])
A, C = np.zeros((STAGES, STAGES)), np.zeros((STAGES, STAGES))
A[1, :1] = 3.0
A[2, :2] = 2.849394379747939, 0.45842242204463923
A[3, :3] = -6.954028509809101, 2.489845061869568, -10.358996098473584
A[4, :4] = 2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641
A[5:, :5] = -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946
A[6:, 5] = A[7, 6] = 1.0
C[1, :1] = -14.155112264123755
C[2, :2] = -17.97296035885952, -2.859693295451294
C[3, :3] = 147.12150275711716, -1.41221402718213, 71.68940251302358
C[4, :4] = 165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306
C[5, :5] = 24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471
C[6, :4] = 30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783
C[6, 4:6] = -19.097331116725623, -28.087943162872662
C[7, :4] = 37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047
C[7, 4:7] = -40.06618937091002, -54.66780262877968, -9.48861652309627
H = np.array([  # weights of the dense output, of order 4
    [25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204,
     0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493],
    [-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796,
     20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372],
    [11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643,
     -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722],
])  # fmt: skip


@function
def rodas(law, push, mass, t, s, h, work):
    """One step of Rodas5P from y into `new` of `work`; u (8, 5) holds the stages, the last one the error estimate.

    The matrix 1/(hγ) − J has a simple shape: x follows v, the works follow all, so that only v needs a division.
    """
    y, u, new = work.y, work.u, work.new
    x, v, z = y[0], y[1], y[2]
    k, per_h, per_mass, place = push.stiffness, 1.0 / h, 1.0 / mass, h * GAMMA
    f_a, f_t = applied(push, t, x)
    f_v, f_z, z_v, z_z = jacobian(law, s, v, z)
    f = respond(law, s, v, z)[0]
    bristle = 1.0 / (1.0 / place - z_z)
    velocity = 1.0 / (1.0 / place + (f_v + k * place + f_z * z_v * bristle) * per_mass)
    for a in range(STAGES):
        x, v, z = y[0], y[1], y[2]
        r0 = r1 = r2 = r3 = r4 = 0.0
        for b in range(a):
            x += A[a, b] * u[b, 0]
            v += A[a, b] * u[b, 1]
            z += A[a, b] * u[b, 2]
            c = C[a, b] * per_h
            r0 += c * u[b, 0]
            r1 += c * u[b, 1]
            r2 += c * u[b, 2]
            r3 += c * u[b, 3]
            r4 += c * u[b, 4]
        force = applied(push, t + ALPHA[a] * h, x)[0]
        held, rate = respond(law, s, v, z)
        r0 += v
        r1 += (force - held + D[a] * h * f_t) * per_mass
        r2 += rate
        r3 += force * v + D[a] * h * f_t * y[1]
        r4 += held * v
        v = (r1 - (k * place * r0 + f_z * bristle * r2) * per_mass) * velocity
        x, z = (r0 + v) * place, (r2 + z_v * v) * bristle
        u[a, 0], u[a, 1], u[a, 2] = x, v, z
        u[a, 3] = (r3 + f_a * v - k * y[1] * x) * place
        u[a, 4] = (r4 + (f + f_v * y[1]) * v + f_z * y[1] * z) * place
    for j in range(5):
        new[j] = y[j] + u[STAGES - 1, j]
        for b in range(STAGES - 1):
            new[j] += A[STAGES - 1, b] * u[b, j]


@function
def continue_into(y, new, u, dense):
    """Polynomials of the step into `dense` (5, 5): y(θ) = Σ dense[k]·θ^k, 0 <= θ <= 1."""
    for j in range(5):
        a = b = c = 0.0
        for k in range(STAGES):
            a += H[0, k] * u[k, j]
            b += H[1, k] * u[k, j]
            c += H[2, k] * u[k, j]
        dense[0, j], dense[1, j], dense[2, j] = y[j], new[j] - y[j] + a, b - a
        dense[3, j], dense[4, j] = c - b, -c


@function
def inside(dense, j, theta):
    """Component j within the step."""
    total = 0.0
    for k in range(dense.shape[0] - 1, -1, -1):
        total = total * theta + dense[k, j]
    return total
