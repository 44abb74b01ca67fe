"""A mass on a belt, m q'' + k q = friction, three ways: SciPy with a smoothed law, SciPy with events, slipmode.

Prints a table: lines of code, time of a run (the least of five), error against the closed form. docs/tutorial/python.md
explains it. A duration other than 200 may be given.

    PYTHONPATH=build/release/python python3 python/examples/belt_oscillator.py
"""

import inspect
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

import slipmode as sm

MU_S, MU_K, SPEED = 0.4, 0.2, 0.1  # m = k = normal load = 1
END = float(sys.argv[1]) if len(sys.argv) > 1 else 200.0
TIMES = np.linspace(0.0, END, round(100.0 * END) + 1)


def closed_form(t):
    """Stick until the spring holds mu_s, slip about mu_k until the belt's speed is reached again."""
    step = MU_S - MU_K
    slip = 2.0 * (np.pi - np.arctan(step / SPEED))
    stick = 2.0 * step / SPEED
    tau = np.mod(t, slip + stick)  # time 0 is the release
    sliding = MU_K + step * np.cos(tau) + SPEED * np.sin(tau)
    return np.where(tau < slip, sliding, MU_K - step + SPEED * (tau - slip))


def smoothed(epsilon, drop):
    def right_side(t, x):
        sliding = SPEED - x[1]
        mu = MU_K + (MU_S - MU_K) * np.exp(-abs(sliding) / drop)
        return [x[1], mu * np.tanh(sliding / epsilon) - x[0]]

    found = solve_ivp(right_side, (0.0, END), [MU_S, SPEED], t_eval=TIMES, method="Radau", rtol=1e-8, atol=1e-10)
    return found.y[0]


def events(rtol):
    def slip(t, x):
        return [x[1], MU_K - x[0]]

    def stick(t, x):
        return [SPEED, 0.0]

    def caught(t, x):
        return x[1] - SPEED

    def released(t, x):
        return x[0] - MU_S

    caught.terminal, caught.direction = True, 1.0
    released.terminal, released.direction = True, 1.0
    t, x, sticks, pieces = 0.0, [MU_S, SPEED], False, []
    while t < END:
        right_side, event = (stick, released) if sticks else (slip, caught)
        found = solve_ivp(right_side, (t, END), x, events=event, dense_output=True, rtol=rtol, atol=1e-2 * rtol)
        wanted = TIMES[(TIMES >= t) & (TIMES <= found.t[-1])]
        pieces.append(found.sol(wanted)[0])
        last = wanted[-1] if len(wanted) else t
        t, x, sticks = found.t[-1], [found.y[0, -1], SPEED], not sticks
        if last == t and t < END:
            pieces[-1] = pieces[-1][:-1]
    return np.concatenate(pieces)


def with_slipmode():
    scene = {
        "units": "dimensionless",
        "structure": {"kind": "masses", "mass": 1.0, "link": [{"at": 1, "stiffness": 1.0}]},
        "contact": [{"at": 1, "law": "coulomb", "mu_s": MU_S, "mu_k": MU_K, "normal_load": 1.0}],
        "drive": {"kind": "belt", "speed": SPEED},
        "initial": {"displacement": [MU_S], "velocity": [SPEED]},
        "time": {"duration": END, "sample": TIMES[1]},
    }
    return sm.simulate(scene).q[:, 0]


def lines_of(function):
    """Lines that are neither empty nor comments."""
    lines = [line.strip() for line in inspect.getsource(function).splitlines()]
    return sum(1 for line in lines if line and not line.startswith("#"))


def measured(function, *arguments):
    times = []
    for _ in range(5):
        begin = time.perf_counter()
        q = function(*arguments)
        times.append(time.perf_counter() - begin)
    assert q.shape == TIMES.shape, (q.shape, TIMES.shape)
    return min(times), np.abs(q - closed_form(TIMES)).max()


def main():
    exact = closed_form(TIMES)
    print(f"largest displacement {np.abs(exact).max():.3f}")
    print("| | lines | time, ms | largest error |")
    print("|---|---|---|---|")
    for name, function, arguments in (
            ("solve_ivp, smoothed, 1e-5 and 1e-3", smoothed, (1e-5, 1e-3)),
            ("solve_ivp, smoothed, 1e-7 and 1e-4", smoothed, (1e-7, 1e-4)),
            ("solve_ivp, smoothed, 1e-9 and 1e-5", smoothed, (1e-9, 1e-5)),
            ("solve_ivp, events, rtol 1e-3", events, (1e-3,)), ("solve_ivp, events, rtol 1e-10", events, (1e-10,)),
            ("slipmode", with_slipmode, ())):
        seconds, error = measured(function, *arguments)
        print(f"| {name} | {lines_of(function)} | {1e3 * seconds:.3g} | {error:.1e} |")


if __name__ == "__main__":
    main()
