"""Runs from Python: closed forms, the executable's files, views, errors, Ctrl-C, threads."""

import copy
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import slipmode as sm

EXECUTABLE = os.environ["SLIPMODE_EXECUTABLE"]
DATASETS = pathlib.Path(os.environ["SLIPMODE_SOURCE_DIR"]) / "datasets"

# A mass on a belt: m = 1, k = 1, no damping, Coulomb friction without a step, N = 1.
BELT = {
    "title": "belt oscillator",
    "units": "dimensionless",
    "structure": {"kind": "masses", "mass": 1.0, "link": [{"at": 1, "stiffness": 1.0}]},
    "contact": [{"at": 1, "law": "coulomb", "mu_s": 0.3, "mu_k": 0.3, "normal_load": 1.0}],
    "drive": {"kind": "belt", "speed": 2.0},
    "time": {"duration": 10.0, "sample": 0.01},
    "initial": {"displacement": [0.5], "velocity": [0.0]},
}


def executable(*arguments):
    done = subprocess.run([EXECUTABLE, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


class ClosedForm(unittest.TestCase):
    def test_a_slipping_mass_swings_about_its_shifted_centre(self):
        # The belt outruns the mass (largest speed 0.2 < 2), so friction is the constant mu N = 0.3:
        # q = 0.3 + 0.2 cos t, v = -0.2 sin t.
        run = sm.simulate(BELT)
        np.testing.assert_allclose(run.t, np.arange(1001) * 0.01, atol=1e-12)
        np.testing.assert_allclose(run.q[:, 0], 0.3 + 0.2 * np.cos(run.t), atol=1e-13)
        np.testing.assert_allclose(run.v[:, 0], -0.2 * np.sin(run.t), atol=1e-13)
        np.testing.assert_allclose(run.lambda_, 0.3, atol=1e-15)
        self.assertEqual(len(run.events), 0)

    def test_a_mass_taken_along_sticks_until_the_spring_holds_it(self):
        # From q = 0 at the belt's speed V = 0.1 it sticks, q = V t, and lets go where k q = mu N: t = 0.3 / 0.1.
        run = sm.simulate(sm.Scene.load(BELT, set={"drive.speed": 0.1, "initial.displacement": [0.0],
                                                   "initial.velocity": [0.1]}))
        first = run.events[0]
        self.assertAlmostEqual(first["time"], 3.0, delta=1e-13)
        self.assertEqual(first["kind"], 1)  # release
        self.assertAlmostEqual(first["displacement"], 0.3, delta=1e-14)
        self.assertLess(abs(run.audit.residual), 1e-12)

    def test_matrices_and_contacts_make_the_same_model_as_masses(self):
        scene = (sm.structure(np.eye(1), np.zeros((1, 1)), np.eye(1)) +
                 sm.contact(1, "coulomb", mu_s=0.3, mu_k=0.3, normal_load=1.0) +
                 {name: BELT[name] for name in ("units", "drive", "time", "initial")})
        np.testing.assert_array_equal(sm.simulate(scene).q, sm.simulate(BELT).q)

    def test_scipys_sparse_matrices_are_taken(self):
        import scipy.sparse

        n = 5
        K = scipy.sparse.diags([-np.ones(n - 1), 2.0 * np.ones(n), -np.ones(n - 1)], [-1, 0, 1]).tocsr()
        scene = (sm.structure(scipy.sparse.identity(n, format="csc"), 0.0 * K, K) +
                 sm.contact(n, "coulomb", mu_s=0.3, mu_k=0.2, normal_load=1.0) +
                 {"units": "dimensionless", "drive": {"kind": "belt", "speed": 0.1}, "time": {"duration": 1.0}})
        # Natural frequencies of a chain fixed at both ends: 2 sin(k pi / 2(n + 1)).
        expected = 2.0 * np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1)))
        np.testing.assert_allclose(sm.modes(scene).slipping.omega, expected, rtol=1e-13)


class Scenes(unittest.TestCase):
    @unittest.skipIf(sys.version_info < (3, 11), "tomllib came with Python 3.11")
    def test_a_dict_is_the_same_scene_as_its_file(self):
        import tomllib

        for dataset in sorted(DATASETS.glob("*/scene.toml")):
            with self.subTest(dataset.parent.name):
                tables = tomllib.loads(dataset.read_text())
                self.assertEqual(sm.Scene.load(tables).toml(), sm.Scene.load(dataset).toml())

    def test_a_pickled_scene_is_the_same_from_the_same_file(self):
        scene = sm.Scene.load(DATASETS / "chain10/scene.toml", set={"drive.speed": 0.25})
        again = pickle.loads(pickle.dumps(scene))
        self.assertEqual((again.toml(), again.path, again.overrides), (scene.toml(), scene.path, scene.overrides))
        self.assertEqual(again.get("drive.speed"), 0.25)
        self.assertEqual(pickle.loads(pickle.dumps(sm.Scene.load(BELT))).toml(), sm.Scene.load(BELT).toml())

    def test_keys_are_set_and_asked_for(self):
        scene = sm.Scene.load(DATASETS / "chain10/scene.toml", set={"drive.speed": 0.25})
        self.assertEqual(scene.get("drive.speed"), 0.25)
        self.assertEqual(sm.Scene.load(scene, set={"contact.0.mu_s": 0.5}).get("drive.speed"), 0.25)
        self.assertEqual(scene.overrides, ["drive.speed=0.25"])
        self.assertEqual(scene.size, 10)

    def test_times_left_to_the_periods_are_those_of_the_keys_set(self):
        # A hundred times as stiff: periods, and all that is left to them, a tenth as long.
        tables = {"units": "SI", "structure": {"kind": "chain", "masses": 3, "stiffness": 400.0},
                  "contact": [{"at": 3, "law": "coulomb", "mu_s": 0.4, "mu_k": 0.3, "normal_load": 1.0}],
                  "drive": {"kind": "belt", "speed": 0.1}, "validation": {"horizon": 5.0}}
        scene = sm.Scene.load(tables)
        stiffer = scene.set(structure__stiffness=4e4)
        self.assertEqual(scene.set({"structure.stiffness": 4e4}).toml(), stiffer.toml())
        self.assertEqual(stiffer.overrides, ["structure.stiffness=40000.0"])
        for own in (stiffer, stiffer.set(drive__speed=0.1)):
            self.assertAlmostEqual(sm.simulate(own).t[-1] / sm.simulate(scene).t[-1], 0.1, delta=1e-3)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "again.toml"
            path.write_text(scene.toml())
            self.assertEqual(path.read_text().count("[validation]\nhorizon = 5.0\n"), 1)
            for table in ("[time]", "[ensemble]", "[reduction]", "[flow]"):
                self.assertNotIn(table, path.read_text())
            again = sm.Scene.load(path, set={"structure.stiffness": 4e4})
            np.testing.assert_array_equal(sm.simulate(again).q, sm.simulate(stiffer).q)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_a_run_is_the_executables_byte_for_byte(self):
        for name in ("chain10", "beam_12hz", "backlash_4mass"):
            with self.subTest(name):
                scene = DATASETS / name / "scene.toml"
                executable("simulate", scene, "--single", "-o", self.folder / "theirs.h5")
                sm.simulate(scene).save(self.folder / "ours.h5")
                self.assertEqual((self.folder / "ours.h5").read_bytes(), (self.folder / "theirs.h5").read_bytes())

    def test_what_is_saved_reads_as_it_was(self):
        run = sm.simulate(DATASETS / "chain10/scene.toml")
        run.save(self.folder / "run.h5")
        again = sm.read(self.folder / "run.h5")
        self.assertEqual(again.kind, "trajectory")
        self.assertEqual(sorted(run._store.names()), sorted(again._store.names()))
        np.testing.assert_array_equal(run.q, again.q)
        np.testing.assert_array_equal(run.events, again.events[list(run.events.dtype.names)])
        self.assertEqual(run.unit("trajectory/q"), again.unit("trajectory/q"))
        self.assertEqual(again.scene.toml(), run.scene.toml())

    def test_a_folder_that_is_not_there_is_refused(self):
        with self.assertRaisesRegex(sm.InvalidInput, "does not exist"):
            sm.simulate(BELT).save(self.folder / "none" / "run.h5")


class Views(unittest.TestCase):
    def test_samples_are_not_copied_and_outlive_their_run(self):
        run = sm.simulate(BELT)
        self.assertTrue(np.shares_memory(run.q, run.q))
        self.assertTrue(np.shares_memory(run.q, run["trajectory/q"]))
        self.assertFalse(run.q.flags.owndata)
        q = run.q
        expected = q.copy()
        del run
        for _ in range(20):
            sm.simulate(BELT)  # whatever was freed is written over
        np.testing.assert_array_equal(q, expected)

    def test_asking_for_samples_takes_no_memory(self):
        # 400000 instants of ten masses: 64 MB of q and v, which a copy would double.
        program = """
import resource, slipmode as sm, pathlib, sys
scene = sm.Scene.load(sys.argv[1], set={"time.duration": 4000.0, "time.transient": 0.0, "time.sample": 0.01})
run = sm.simulate(scene)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
total = run.q[::100].sum() + run.v[::100].sum()
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print((after - before) * 1024, run.q.nbytes + run.v.nbytes)
"""
        done = subprocess.run([sys.executable, "-c", program, str(DATASETS / "chain10/scene.toml")],
                              capture_output=True, text=True, check=True)
        grown, held = map(int, done.stdout.split())
        self.assertGreater(held, 60e6)
        self.assertLess(grown, 0.1 * held)

    def test_views_are_not_to_be_written_to(self):
        with self.assertRaises(ValueError):
            sm.simulate(BELT).q[0] = 1.0


class Errors(unittest.TestCase):
    def test_bad_scenes_say_what_is_wrong(self):
        for change, words in (({"drive.speed": "fast"}, "speed"), ({"contact.0.mu_k": -1.0}, "mu_k"),
                              ({"time.duration": float("nan")}, "duration"), ({"drive.sped": 1.0}, "speed")):
            with self.subTest(change), self.assertRaisesRegex(sm.InvalidInput, words):
                sm.Scene.load(BELT, set=change)
        self.assertTrue(issubclass(sm.InvalidInput, ValueError))
        for source in (None, 3, {"structure": {"kind": object()}}, "no/such/file.toml"):
            with self.subTest(source), self.assertRaises(sm.InvalidInput):
                sm.simulate(source)

    def test_options_that_are_none_are_refused(self):
        for options, words in (({"thread": 1}, "valid: threads"), ({"threads": -1}, "an integer from 0"),
                               ({"threads": 1.5}, "an integer from 0"), ({"threads": True}, "an integer from 0"),
                               ({"progress": 3}, "function")):
            with self.subTest(options), self.assertRaisesRegex(sm.InvalidInput, words):
                sm.simulate(BELT, **options)

    def test_arguments_that_a_study_does_not_take_are_refused_in_a_line(self):
        for call, words in ((lambda: sm.sweep(BELT, over=("drive.speed", [0.1])), r"over=\('drive.speed', \[0.1\]\)\): expected sw"),
                            (lambda: sm.sweep(BELT, "drive.speed", 0.2), r"expected sweep\(.*values: List\[float\]"),
                            (lambda: sm.simulate(BELT, 3), r", 3\): expected simulate\(scene: Scene, \*\*options\)"),
                            (lambda: sm.validate(BELT), "basis: Result"), (lambda: sm.modes(BELT, "a"), "count: int"),
                            (lambda: sm.reduce(BELT, "lnm", "a"), "modes: int"), (lambda: sm.spectrum(3), "orbit: Result")):
            with self.subTest(words), self.assertRaisesRegex(sm.InvalidInput, words) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))

    def test_a_run_that_fails_keeps_what_came_before(self):
        # Two events in a window of 1e-3 are made the limit; stick-slip at V = 0.1 has them 1 apart: a window of 10.
        scene = sm.Scene.load(DATASETS / "chain10/scene.toml",
                              set={"flow.max_events_per_window": 3, "flow.zeno_window": 200.0, "time.transient": 0.0})
        with self.assertRaises(sm.NumericalFailure) as caught:
            sm.simulate(scene)
        failure = caught.exception
        self.assertIsInstance(failure, RuntimeError)
        self.assertGreater(failure.time, 0.0)
        self.assertEqual(failure.state.shape, (20,))
        self.assertLess(failure.result.t[-1], failure.time)
        self.assertIn("incomplete", dir(failure.result))


class Interrupts(unittest.TestCase):
    # Whole it would take hours: a run that ends was ended.
    LONG = {"time.duration": 1e10, "time.transient": 9.9999e9}

    def test_ctrl_c_ends_a_run(self):
        scene = sm.Scene.load(DATASETS / "chain10/scene.toml", set=self.LONG)
        with self.assertRaises(KeyboardInterrupt):
            sm.simulate(scene, progress=lambda *told: os.kill(os.getpid(), signal.SIGINT))
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)
        self.assertEqual(len(sm.simulate(BELT).t), 1001)  # and the next call is not stopped

    def test_ctrl_c_ends_calls_of_other_threads(self):
        scene = sm.Scene.load(DATASETS / "chain10/scene.toml", set=self.LONG)
        ended = []

        def run(runs):
            try:
                sm.simulate(scene, progress=lambda *told: runs.set())
            except KeyboardInterrupt:
                ended.append(True)

        running = [threading.Event() for _ in range(2)]
        threads = [threading.Thread(target=run, args=(runs,)) for runs in running]
        for thread in threads:
            thread.start()
        for runs in running:
            runs.wait()
        with self.assertRaises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
            threading.Event().wait(60.0)
        for thread in threads:
            thread.join()
        self.assertEqual(ended, [True, True])

    def test_a_handler_saved_during_a_call_may_be_set_again_later(self):
        # It is ours, and hands Ctrl-C on to Python's, not to itself.
        program = """
import ctypes, os, signal, slipmode as sm, sys
libc = ctypes.CDLL(None)
libc.signal.argtypes, libc.signal.restype = [ctypes.c_int, ctypes.c_void_p], ctypes.c_void_p
scene = sm.Scene.load(sys.argv[1], set={"time.duration": 1e10, "time.transient": 9.9999e9})
def save(*told):
    global saved
    saved = libc.signal(signal.SIGINT, None)
    libc.signal(signal.SIGINT, saved)
    raise ZeroDivisionError
try:
    sm.simulate(scene, progress=save)
except ZeroDivisionError:
    libc.signal(signal.SIGINT, saved)
try:
    sm.simulate(scene, progress=lambda *told: os.kill(os.getpid(), signal.SIGINT))
except KeyboardInterrupt:
    print("stopped")
"""
        done = subprocess.run([sys.executable, "-c", program, str(DATASETS / "chain10/scene.toml")],
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, "stopped\n"), done.stderr)

    def test_progress_is_told_and_its_errors_come_back(self):
        scene = sm.Scene.load(DATASETS / "chain10/scene.toml", set=self.LONG)
        told = []

        def tell(part, done, total):
            told.append((part, done, total))
            if len(told) == 3:
                raise ZeroDivisionError

        with self.assertRaises(ZeroDivisionError):
            sm.simulate(scene, progress=tell)
        self.assertEqual({(part, total) for part, _, total in told}, {("simulate", 1000)})
        self.assertEqual([done for _, done, _ in told], sorted(done for _, done, _ in told))


class Threads(unittest.TestCase):
    def test_other_threads_run_meanwhile_and_get_the_same(self):
        scene = sm.Scene.load(DATASETS / "chain10/scene.toml")
        alone = sm.simulate(scene).q
        found, counted, done = [], [0], threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1
                time.sleep(0)

        threads = [threading.Thread(target=lambda: found.append(sm.simulate(scene))) for _ in range(4)]
        counter = threading.Thread(target=count)
        for thread in [counter, *threads]:
            thread.start()
        for thread in threads:
            thread.join()
        done.set()
        counter.join()
        self.assertEqual(len(found), 4)
        for run in found:
            np.testing.assert_array_equal(run.q, alone)
        self.assertGreater(counted[0], 100)  # four runs take 0.5 s and more: without the lock released it gets none

    def test_several_threads_may_be_the_first_to_look_at_a_run(self):
        for _ in range(20):
            run, together = sm.simulate(BELT), threading.Barrier(4)
            with tempfile.TemporaryDirectory() as folder:
                paths = [pathlib.Path(folder) / f"{k}.h5" for k in range(4)]

                def save(path):
                    together.wait()
                    run.save(path)

                threads = [threading.Thread(target=save, args=(path,)) for path in paths]
                for thread in threads:
                    thread.start()
                for thread in threads:
                    thread.join()
                self.assertEqual(len({path.read_bytes() for path in paths}), 1)


class Shown(unittest.TestCase):
    def test_a_result_says_what_it_has(self):
        run = sm.simulate(BELT)
        text = repr(run)
        self.assertIn("<slipmode trajectory>", text)
        self.assertRegex(text, r"trajectory/q +1001 x 1 +1 +displacements, time x dof")
        self.assertIn("<td>trajectory/q</td>", run._repr_html_())
        self.assertIn("q", dir(run))
        self.assertEqual(repr(copy.copy(run)), text)
        with self.assertRaisesRegex(AttributeError, "a trajectory has no 'qq'; there are: "):
            run.qq

    def test_options_are_documented_where_they_are_declared(self):
        self.assertIn("bound on the orbit's relative mismatch after a period", sm.find_orbit.__doc__)
        self.assertIn("threads", sm.simulate.__doc__)
        self.assertRegex(sm.Scene.__doc__, r'law = "coulomb"\n +mu_s: static coefficient \[1\], required')


if __name__ == "__main__":
    unittest.main()
