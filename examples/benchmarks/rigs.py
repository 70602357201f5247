"""What the benchmarks simulate, and a textbook filter, without Kalmanscope: plain Python, four-stage Runge-Kutta steps."""
import math
import random


def runge_kutta(rate, state, forces, step):
    """A step under the forces at its beginning, middle and end."""
    first = rate(state, forces[0])
    second = rate([x + step / 2 * dx for x, dx in zip(state, first)], forces[1])
    third = rate([x + step / 2 * dx for x, dx in zip(state, second)], forces[1])
    fourth = rate([x + step * dx for x, dx in zip(state, third)], forces[2])
    return [x + step / 6 * (a + 2 * b + 2 * c + d) for x, a, b, c, d in zip(state, first, second, third, fourth)]


def bouc_wen_sweep(seconds=180.0, rate=750, fine=8):
    """40 N from 20 Hz to 50 Hz at 10 Hz a minute, with the true parameters of the benchmark (Noël and Schoukens 2016).

    Rows of time [s], force [N], displacement [m].
    """
    step = 1 / (rate * fine)

    def force(t):
        return 40 * math.sin(2 * math.pi * (20 * t + t * t / 12))

    def motion(state, f):
        x, v, z = state
        return v, (f - 10 * v - 5e4 * x - z) / 2, 5e4 * v - 1e3 * (0.8 * abs(v) * z - 1.1 * v * abs(z))

    state, rows = [0.0, 0.0, 0.0], []
    for k in range(round(seconds * rate) * fine):
        t = k * step
        if k % fine == 0:
            rows.append((t, force(t), state[0]))
        state = runge_kutta(motion, state, [force(t), force(t + step / 2), force(t + step)], step)
    return rows


EMPS = {"M": 95.1089, "Fv": 203.5034, "Fc": 20.3935, "o": -3.1648}  # kg, N s/m, N, N


def emps(targets, seed, noise=1e-5, fine=10):
    """The drive under its own cascade of controllers; every two seconds it goes to another target [m].

    Gains and limit of 10 V are those of the rig (Janot, Gautier and Brunot 2019); it sticks where friction holds the force.
    Rows of time [s], force [N], displacement [m] at 1 kHz.
    """
    draw, rows, (x, v) = random.Random(seed), [], (0.0, 0.0)
    place, begin, step = targets[0], targets[0], 1e-3 / fine
    for k in range(2000 * len(targets)):
        if k % 2000 == 0:
            begin, place = place, targets[k // 2000]
        part = min(k % 2000 / 1200, 1.0)  # a move of 1.2 s, then rest
        aim = begin + (place - begin) * part * part * (3 - 2 * part)
        volts = max(-10.0, min(10.0, 243.45 * (160.18 * (aim - x) - v)))
        force = 35.15065 * volts
        rows.append((k * 1e-3, force, x + draw.gauss(0, noise)))
        for _ in range(fine):
            push = force - EMPS["o"]
            if v == 0 and abs(push) <= EMPS["Fc"]:
                continue
            side = math.copysign(1.0, v if v else push)

            def motion(state, _):
                return state[1], (push - EMPS["Fv"] * state[1] - side * EMPS["Fc"]) / EMPS["M"]

            x, after = runge_kutta(motion, [x, v], [0.0] * 3, step)
            v = 0.0 if after * side < 0 else after
    return rows


def van_der_pol(seed=36):
    """The truth of Crassidis and Junkins, example 3.6, and its readings: rows of time, force, displacement."""
    draw, state, rows = random.Random(seed), [1.0, 0.0], []
    for k in range(1000):
        rows.append((k * 0.01, 0.0, state[0] + draw.gauss(0, 0.01)))
        state = runge_kutta(lambda y, _: (y[1], -2 * (y[0] ** 2 - 1) * y[1] - y[0]), state, [0.0] * 3, 0.01)
    return rows


def product(a, b):
    return [[sum(x * y for x, y in zip(row, column)) for column in zip(*b)] for row in a]


def textbook_filter(readings, q, book):
    """The EKF of that example: c and its standard deviation behind each reading.

    `book`: the covariance moves by exp(A dt), as in the book's program; otherwise by the derivative of the Runge-Kutta step.
    """
    dt, r, y = 0.01, 1e-4, [1.0, 0.0, 0.0]
    P, path = [[1000.0 * (i == j) for j in range(3)] for i in range(3)], []

    def rate(y, _):
        return y[1], -2 * y[2] * (y[0] ** 2 - 1) * y[1] - y[0], 0.0

    def move(y):
        return runge_kutta(rate, y, [0.0] * 3, dt)

    for z in readings:
        gain = [row[0] / (P[0][0] + r) for row in P]
        y = [value + k * (z - y[0]) for value, k in zip(y, gain)]
        P = [[P[i][j] - gain[i] * P[0][j] for j in range(3)] for i in range(3)]
        path.append((y[2], math.sqrt(P[2][2])))
        if book:
            A = [[0, dt, 0], [dt * (-4 * y[2] * y[0] * y[1] - 1), dt * -2 * y[2] * (y[0] ** 2 - 1), dt * -2 * (y[0] ** 2 - 1) * y[1]], [0] * 3]
            phi = power = [[float(i == j) for j in range(3)] for i in range(3)]
            for n in range(1, 12):
                power = [[value / n for value in row] for row in product(power, A)]
                phi = [[a + b for a, b in zip(*rows)] for rows in zip(phi, power)]
        else:
            ends = [[move([value + h * (i == j) for i, value in enumerate(y)]) for h in (1e-5, -1e-5)] for j in range(3)]
            phi = [[(up[i] - down[i]) / 2e-5 for up, down in ends] for i in range(3)]
        y, P = move(y), product(product(phi, P), list(zip(*phi)))
        P[2][2] += q * dt
    return path


STOREYS = [k / 1.1 for k in [862.07] * 5 + [554.17] * 6 + [453.51] * 3 + [291.23] * 3 + [256.46] * 2 + [171.70]]  # stiffness over mass [1/s²]
RAYLEIGH = (0.1298, 0.0155)  # 1/s, s: 5 % in the first two modes


def low_passed(draw, seconds, dt, cutoff):
    """White noise behind two equal low-passes of first order [Hz]."""
    share, a, b, values = 1 - math.exp(-2 * math.pi * cutoff * dt), 0.0, 0.0, []
    for _ in range(round(seconds / dt)):
        a += share * (draw.gauss(0, 1) - a)
        b += share * (a - b)
        values.append(b)
    return values


def storeys(seconds=30.0, dt=1e-3, noise=0.05, seed=20):
    """Accelerations of twenty storeys, shaken at storeys 1, 5 and 18, with noise of a share of their RMS; one list a sample."""
    draw, n, (of_mass, of_stiffness) = random.Random(seed), len(STOREYS), RAYLEIGH
    shakers = [(storey - 1, low_passed(draw, seconds, dt, 20.0)) for storey in (1, 5, 18)]

    def accelerations(state, forces):
        x, v = state[:n], state[n:]
        shear = [k * (x[i] - (x[i - 1] if i else 0) + of_stiffness * (v[i] - (v[i - 1] if i else 0))) for i, k in enumerate(STOREYS)] + [0.0]
        return [forces.get(i, 0.0) - of_mass * v[i] - shear[i] + shear[i + 1] for i in range(n)]

    state, rows = [0.0] * (2 * n), []
    for k in range(len(shakers[0][1])):
        forces = {place: values[k] for place, values in shakers}
        rows.append(accelerations(state, forces))
        state = runge_kutta(lambda y, f: y[n:] + accelerations(y, f), state, [forces] * 3, dt)
    sizes = [noise * math.sqrt(sum(a * a for a in column) / len(rows)) for column in zip(*rows)]
    return [[a + draw.gauss(0, size) for a, size in zip(row, sizes)] for row in rows], sizes
