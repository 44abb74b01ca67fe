"""How far ranks under mpirun go: a discrete-event simulation of results/crew.cpp with measured times of values.

    python3 bench/ranks_model.py build/release/cli/slipmode

Measures some rows of three studies with one thread each, then prints the efficiency of 10 to 10,000 cores: the sum of all
values' times over cores times the job's time. docs/past-one-machine.md has its table. Constants: measured there.
"""

import heapq
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

START = 0.4        # s until ranks compute; what a study prepares in every rank comes on top
BUSY = 0.25        # s of work that a rank asks for
WATCH = 2e-3       # s between rank 0's looks for messages
WISH = 5e-6        # s of rank 0 to answer for pieces
PER_BYTE = 77e-6 / 9100  # s of rank 0 to check and write a record
FINISH = 80e-6 / 9100     # s per byte to make the result at the end
NETWORK = 20e-6    # s, a message between machines
THREADS = 32       # of a rank

DATASETS = pathlib.Path(__file__).parents[1] / "datasets"


def measured(executable, words):
    """Seconds until the first piece has begun, of each piece, and bytes of its record, from the journal's growth."""
    with tempfile.TemporaryDirectory() as folder:
        journal = pathlib.Path(folder) / "r.h5.journal"
        begin = time.perf_counter()
        run = subprocess.Popen([executable, *words, "-o", folder + "/r.h5", "--threads", "1", "--quiet"])
        sizes, times = [], []
        while run.poll() is None:
            try:
                size = journal.stat().st_size
            except FileNotFoundError:
                size = 0
            if size > 0 and (not sizes or size != sizes[-1]):
                sizes.append(size)
                times.append(time.perf_counter() - begin)
            time.sleep(2e-4)
        if run.returncode != 0:
            sys.exit(run.returncode)
    # The journal begins before what a study prepares in every rank; its first piece costs about what the second does.
    pieces = np.diff(times)
    return times[0] + max(pieces[0] - pieces[1], 0.0), pieces[1:], (sizes[-1] - sizes[0]) / (len(sizes) - 1)


def simulate(pieces, prepare, bytes_of_record, cores):
    """Efficiency, and the job's time in s."""
    threads = min(THREADS, cores)
    ranks = cores // threads
    start = START + prepare
    fair = 2 * ranks
    queue, given = len(pieces), 0
    server_free = 0.0
    idle = [threads] * ranks       # threads without a piece
    held = [[] for _ in range(ranks)]
    asking = [False] * ranks
    found = [0] * ranks
    record = bytes_of_record * PER_BYTE
    events = [(start, 0, rank, "ask", 1) for rank in range(ranks)]
    order = ranks

    def push(when, rank, what, number=0):
        nonlocal order
        heapq.heappush(events, (when, order, rank, what, number))
        order += 1

    def served(arrival, work):
        """When rank 0 has dealt with what arrives: at its next look, after what came before."""
        nonlocal server_free
        look = np.ceil(arrival / WATCH) * WATCH
        server_free = max(server_free, look if server_free < arrival else arrival) + work
        return server_free

    end = start
    while events:
        now, _, rank, what, number = heapq.heappop(events)
        if what == "ask":
            asking[rank] = True
            push(now if rank == 0 else served(now + NETWORK, WISH) + NETWORK, rank, "given", number)
            continue
        if what == "given":
            many = min(queue, number, max(1, queue // fair))
            held[rank] = list(range(given, given + many))
            given, queue = given + many, queue - many
            asking[rank] = False
        else:
            found[rank] += 1
            idle[rank] += 1
            end = max(end, now if rank == 0 else served(now + NETWORK, record))
        while idle[rank] and held[rank]:
            idle[rank] -= 1
            push(now + pieces[held[rank].pop(0)], rank, "done")
        if idle[rank] and not held[rank] and queue > 0 and not asking[rank]:
            wish = BUSY / max(now - start, 1e-9) * found[rank]
            push(now, rank, "ask", int(min(max(wish, 1), 1e6)))
            asking[rank] = True
    whole = end + bytes_of_record * FINISH * len(pieces)
    return pieces.sum() / (cores * whole), whole


def main(executable):
    backlash, beam, chain = (str(DATASETS / name / "scene.toml") for name in ("backlash_sdof", "beam_sweep", "chain10"))
    plane = "initial.displacement.0=-3:3:{}", "initial.velocity.0=-3:3:{}"
    fine = ["--over", plane[0].format(6 / 399)]
    studies = {
        "400 x 400 starts": (400, ["orbit", "basins", backlash, *fine, "--over", plane[1].format(6 / 19)]),
        "551 frequencies of a beam": (551, ["sweep", beam, "--over", "drive.frequency=5:60:2"]),
        "1,000 x 1,000 map": (1000, ["orbit", "map", backlash, "--over", "drive.omega=0.1:2:0.0019", "--over",
                                     "drive.amplitude=0.1:3:0.2"]),
        "10^6 values of a sweep": (1000000, ["sweep", chain, "--over", "drive.speed=0.5:0.02:0.004"]),
    }
    print("| study | pieces | a piece, s | its kB | one core | " + " | ".join(f"{cores:,}" for cores in (10, 100, 1000, 10000))
          + " |")
    for name, (count, words) in studies.items():
        prepare, times, size = measured(executable, words)
        places = np.linspace(0, len(times) - 1, count)
        pieces = np.interp(places, np.arange(len(times)), times)
        cells = []
        for cores in (10, 100, 1000, 10000):
            efficiency, seconds = simulate(pieces, prepare, size, cores)
            cells.append(f"{100 * efficiency:.2g} %, {seconds:.3g} s")
        print(f"| {name} | {count:,} | {pieces.mean():.2g}, at most {pieces.max():.2g} | {size / 1000:.0f} | "
              f"{pieces.sum():.3g} s | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
