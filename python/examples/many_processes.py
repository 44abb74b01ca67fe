"""A sweep in several processes: those of concurrent.futures, or of dask.distributed where a scheduler is named, which may
have workers on many machines.

    PYTHONPATH=build/release/python python3 python/examples/many_processes.py [tcp://SCHEDULER:8786]

Workers import slipmode too. Scenes travel to them, tables of numbers back.
"""

import multiprocessing
import pathlib
import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import slipmode as sm

CHAIN = pathlib.Path(__file__).parents[2] / "datasets/chain10/scene.toml"
PROCESSES = 2


def motions(scene, speeds):
    return sm.sweep(scene, "drive.speed", speeds, threads=1).sweep.full.values


def executor_of(arguments):
    if not arguments:  # fresh processes: a fork would copy slipmode's threads' locks
        return ProcessPoolExecutor(PROCESSES, mp_context=multiprocessing.get_context("spawn"))
    from dask.distributed import Client

    return Client(arguments[0]).get_executor()


if __name__ == "__main__":
    scene = sm.Scene.load(CHAIN, set={"contact.0.mu_s": 0.45})
    speeds = sm.values(0.5, 0.31, 0.01)
    with executor_of(sys.argv[1:]) as executor:
        # Neighbours cost alike: each process gets every PROCESSES-th.
        shares = [speeds[k::PROCESSES] for k in range(PROCESSES)]
        found = np.concatenate(list(executor.map(motions, [scene] * PROCESSES, shares)))
    found = found[np.argsort(-found["parameter"])]
    alone = motions(scene, speeds)
    same = all(np.array_equal(found[name], alone[name]) for name in alone.dtype.names)
    print(f"{len(found)} values, {np.count_nonzero(found['period'])} of them periodic; as in one process: {same}")
    sys.exit(0 if same else 1)
