"""Studies from Python beside the executable's files and known values."""

import io
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import time
import unittest

import h5py
import numpy as np

import slipmode as sm

EXECUTABLE = os.environ["SLIPMODE_EXECUTABLE"]
DATASETS = pathlib.Path(os.environ["SLIPMODE_SOURCE_DIR"]) / "datasets"

CHAIN = DATASETS / "chain10/scene.toml"
# A shorter chain10: the numbers need not mean anything, they have to be the executable's.
SHORT = {"structure.masses": 4, "contact.0.at": 4, "time.duration": 400.0, "time.transient": 100.0,
         "ensemble.members": 2}
QUICK = {**SHORT, "validation.transient": 100.0, "validation.block": 200.0, "validation.limit": 800.0,
         "validation.sweep_limit": 400.0, "validation.horizon": 20.0, "validation.lyapunov_duration": 500.0,
         "validation.cost_duration": 50.0, "validation.orbits": [], "validation.modes": [2],
         "validation.speeds.from": 0.5, "validation.speeds.to": 0.3, "validation.speeds.step": 0.1}
BACKLASH = DATASETS / "backlash_sdof/scene.toml"
PLAY = DATASETS / "play_oscillator/scene.toml"
JENKINS = DATASETS / "jenkins_chain/scene.toml"
STOP = DATASETS / "stop_2mass/scene.toml"


class BesideTheExecutable(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def executable(self, *arguments, set={}):
        changes = [word for key, value in set.items() for word in ("--set", f"{key}={value!r}")]
        done = subprocess.run([EXECUTABLE, *map(str, arguments), *changes], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def datasets(self, path):
        found = {}
        with h5py.File(path) as file:
            file.visititems(lambda name, node: found.update({name: (node[()], dict(node.attrs))})
                            if isinstance(node, h5py.Dataset) else None)
        return found

    def assert_same(self, result, path, apart=()):
        """Every dataset and attribute, but for what a clock measured and those `apart`."""
        result.save(self.folder / "ours.h5")
        ours, theirs = self.datasets(self.folder / "ours.h5"), self.datasets(path)
        self.assertEqual(ours.keys(), theirs.keys())
        for name, (value, attributes) in theirs.items():
            with self.subTest(name):
                self.assertEqual(ours[name][1], attributes)
                if name not in apart and attributes["units"] != b"s of clock" and "cost" not in name:
                    np.testing.assert_array_equal(ours[name][0], value)

    def test_diagnosis_of_a_record(self):
        run = sm.simulate(BACKLASH)
        run.save(self.folder / "run.h5")
        tools = ["information", "false-neighbours", "spectrum"]
        self.executable("diagnose", f"{self.folder / 'run.h5'}:v/1", "--tools", ",".join(tools), "--references", 500,
                        "--unit", "nats", "-o", self.folder / "theirs.h5")
        options = {"series": "v/1", "tools": tools, "references": 500, "unit": "nats"}
        theirs = self.folder / "theirs.h5"
        self.assert_same(sm.diagnose(self.folder / "run.h5", **options), theirs)
        in_memory = sm.diagnose(run, **options)  # no file to name
        self.assert_same(in_memory, theirs, ("diagnosis/series/name", "diagnosis/series/what"))

    def test_diagnosis_of_samples(self):
        x = 0.3
        logistic = np.empty(4000)
        for k in range(len(logistic)):
            logistic[k] = x = 4.0 * x * (1.0 - x)
        found = sm.diagnose(logistic, tools=["kantz"], unit="nats")
        self.assertEqual(found.kind, "series")
        self.assertTrue(np.any(np.isclose(found.findings["value"], np.log(2.0), atol=0.05)), found.findings)
        sine = sm.diagnose(record=np.sin(0.1 * np.arange(3000)), interval=0.1, tools=["verdict"])
        self.assertEqual(sine.verdict, "periodic")
        for record, options, words in ((logistic[:1], {}, "2 samples"), (logistic, {"every": 0}, "every"),
                                       (logistic, {"tools": ["wulf"]}, "no such tool"), (3.0, {}, "record"),
                                       (logistic, {"dimension": 101}, "dimension"), (logistic, {"unit": "dB"}, "unit"),
                                       (self.folder / "none.h5", {}, "no such file"), (logistic, {"delai": 3}, "delai")):
            with self.subTest(words), self.assertRaisesRegex(sm.InvalidInput, words):
                sm.diagnose(record, **options)

    def test_modes(self):
        self.executable("modes", CHAIN, "-o", self.folder / "modes.h5")
        self.assert_same(sm.modes(CHAIN), self.folder / "modes.h5")

    def test_ensemble_pod_and_reduction(self):
        scene = sm.Scene.load(CHAIN, set=SHORT)
        self.executable("simulate", CHAIN, "-o", self.folder / "ensemble.h5", set=SHORT)
        self.executable("pod", self.folder / "ensemble.h5", "-o", self.folder / "pod.h5")
        self.executable("reduce", CHAIN, self.folder / "pod.h5", "--modes", 2, "-o", self.folder / "rom.h5", set=SHORT)
        motion = sm.ensemble(scene)
        basis = sm.pod(motion)
        self.assert_same(motion, self.folder / "ensemble.h5")
        self.assert_same(basis, self.folder / "pod.h5")
        self.assert_same(sm.reduce(scene, basis, modes=2), self.folder / "rom.h5")
        self.assert_same(sm.reduce(scene, self.folder / "pod.h5", modes=2), self.folder / "rom.h5")
        self.assertAlmostEqual(basis.shares.sum(), 1.0, delta=1e-14)

    def test_a_basis_of_ones_own(self):
        # Natural modes, handed over as an array and turned among each other: the same model in other coordinates.
        scene = sm.Scene.load(CHAIN, set=SHORT)
        shapes = sm.modes(scene).slipping.shapes
        turn = np.array([[2.0, 1.0], [-1.0, 3.0]])
        expected = sm.simulate(scene, model=sm.reduce(scene, "lnm", modes=2))
        for vectors, modes in ((shapes[:, :2], 0), (shapes, 2), (shapes[:, :2] @ turn, 0)):
            run = sm.simulate(scene, model=sm.reduce(scene, vectors, modes=modes))
            np.testing.assert_allclose(run.q, expected.q, atol=1e-9 * np.abs(expected.q).max())

    def test_validation(self):
        scene = sm.Scene.load(CHAIN, set=QUICK)
        basis = sm.pod(sm.ensemble(scene))
        basis.save(self.folder / "pod.h5")
        self.executable("validate", CHAIN, self.folder / "pod.h5", "-o", self.folder / "validation.h5", set=QUICK)
        self.assert_same(sm.validate(scene, basis), self.folder / "validation.h5")

    def test_validation_and_sweep_under_a_force(self):
        few = {"validation.omegas.from": 0.2, "validation.omegas.to": 0.3, "validation.omegas.step": 0.1,
               "validation.cycles": 40, "validation.kept": 30, "validation.cost_cycles": 0, "ensemble.omegas": [0.2, 0.3]}
        scene = sm.Scene.load(JENKINS, set=few)
        basis = sm.pod(sm.ensemble(scene))
        basis.save(self.folder / "pod.h5")
        self.executable("validate", JENKINS, self.folder / "pod.h5", "-o", self.folder / "validation.h5", set=few)
        own = sm.validate(scene, basis)
        self.assert_same(own, self.folder / "validation.h5")
        # Thirty reduced models hold the same: the first is listed, the rest are counted.
        said = str(own)
        self.assertLess(len(said.splitlines()), 110)
        self.assertIn("29 groups", said)
        self.assertIn("as shaken_validation/models/POM_01", said)
        self.executable("sweep", JENKINS, "--over", "drive.omega=0.2:0.3:0.05", "-o", self.folder / "sweep.h5", set=few)
        self.assert_same(sm.sweep(scene, "drive.omega", sm.values(0.2, 0.3, 0.05)), self.folder / "sweep.h5")

    def test_orbit_and_branch(self):
        self.executable("orbit", "find", BACKLASH, "-o", self.folder / "orbit.h5")
        self.assert_same(sm.find_orbit(BACKLASH), self.folder / "orbit.h5")
        self.executable("orbit", "continue", BACKLASH, "--over", "drive.omega=1.4:1.2", "--start", "2.5,0",
                        "-o", self.folder / "branch.h5")
        branch = sm.continue_orbit(BACKLASH, over="drive.omega", to=1.2, start=[2.5, 0.0])
        self.assert_same(branch, self.folder / "branch.h5")
        np.testing.assert_array_equal(branch["branches/0/points"]["period"], branch["branches/0/points/period"])
        self.executable("orbit", "continue", PLAY, "--over", "drive.omega=0.9:1.3", "--point", "grazing", "--along",
                        "drive.amplitude=1:1.5", "-o", self.folder / "curves.h5")
        curves = sm.continue_orbit(PLAY, over="drive.omega", from_=0.9, to=1.3, point="grazing",
                                   along=("drive.amplitude", 1.0, 1.5))
        self.assert_same(curves, self.folder / "curves.h5")
        self.assertEqual(curves.kind, "curves")
        with self.assertRaisesRegex(sm.NumericalFailure, "no period doubling"):
            sm.continue_orbit(PLAY, over="drive.omega", from_=0.9, to=1.3, point="period-doubling",
                              along=("drive.amplitude", 1.0, 1.5))
        with self.assertRaisesRegex(sm.InvalidInput, "along"):
            sm.continue_orbit(PLAY, over="drive.omega", to=1.3, point="fold")
        self.executable("orbit", "continue", PLAY, "--over", "drive.omega=0.9:1.3", "--by", "balance", "--point", "fold",
                        "--along", "drive.amplitude=0.5:2", "-o", self.folder / "folds.h5")
        folds = sm.continue_orbit(PLAY, over="drive.omega", from_=0.9, to=1.3, by="balance", point="fold",
                                  along=("drive.amplitude", 0.5, 2.0))
        self.assert_same(folds, self.folder / "folds.h5")
        with self.assertRaisesRegex(sm.InvalidInput, "by shooting"):
            sm.continue_orbit(PLAY, over="drive.omega", from_=0.9, to=1.3, by="balance", point="fold", certify=True,
                              along=("drive.amplitude", 0.5, 2.0))

    def test_a_run_of_a_reduced_model(self):
        scene = sm.Scene.load(CHAIN, set=SHORT)
        rom = sm.reduce(scene, sm.pod(sm.ensemble(scene)), modes=3)
        rom.save(self.folder / "rom.h5")
        self.executable("simulate", CHAIN, "--single", "--model", f"rom:{self.folder / 'rom.h5'}", "-o",
                        self.folder / "run.h5", set=SHORT)
        ours = sm.simulate(scene, model=rom)
        self.assert_same(ours, self.folder / "run.h5", apart={"provenance/command"})
        self.assertEqual(ours.q.shape[1], 4)  # lifted
        self.assertLess(np.linalg.matrix_rank(ours.v, tol=1e-9), 4)

    def test_spectrum_and_skeleton(self):
        orbit = sm.find_orbit(BACKLASH, start=[2.5, 0.0])
        orbit.save(self.folder / "orbit.h5")
        self.executable("orbit", "spectrum", self.folder / "orbit.h5", "--harmonics", 9, "--dof", 1,
                        "-o", self.folder / "spectrum.h5")
        self.assert_same(sm.spectrum(orbit, dofs=[1], harmonics=9), self.folder / "spectrum.h5")
        scene = sm.Scene.load(CHAIN, set=SHORT)
        rom = sm.reduce(scene, sm.pod(sm.ensemble(scene)), modes=3)
        rom.save(self.folder / "rom.h5")
        quick, words = {"duration": 3000.0, "max_length": 2}, ("--duration", 3000, "--max-length", 2)
        self.executable("orbit", "skeleton", CHAIN, *words, "-o", self.folder / "skeleton.h5", set=SHORT)
        self.assert_same(sm.skeleton(scene, **quick), self.folder / "skeleton.h5")
        self.executable("orbit", "skeleton", CHAIN, *words, "--compare-with", f"rom:{self.folder / 'rom.h5'}",
                        "-o", self.folder / "skeletons.h5", set=SHORT)
        self.assert_same(sm.skeleton(scene, model=rom, compare=True, **quick), self.folder / "skeletons.h5",
                         apart={"provenance/command"})

    def test_balances(self):
        for flags, options in (((), {}), (("--harmonics", 21, "--certify"), {"harmonics": 21, "certify": True}),
                               (("--harmonics", "auto", "--error", 1e-3), {"error": 1e-3}),
                               (("--samples", 256, "--start", "gap"), {"samples": 256, "start": "gap"})):
            with self.subTest(options):
                self.executable("orbit", "find", PLAY, "--by", "balance", *flags, "-o", self.folder / "balance.h5")
                self.assert_same(sm.find_orbit(PLAY, by="balance", **options), self.folder / "balance.h5")
        self.executable("orbit", "continue", PLAY, "--over", "drive.omega=1:1.1", "--by", "balance", "--certify",
                        "--every", 5, "-o", self.folder / "branch.h5")
        omega = sm.Scene.load(PLAY, set={"drive.omega": 1.0})
        self.assert_same(sm.continue_orbit(omega, over="drive.omega", from_=1.0, to=1.1, by="balance", certify=True,
                                           every=5), self.folder / "branch.h5", apart={"provenance/overrides"})

    def test_mixed_orbits(self):
        for flags, options in ((("--certify",), {"certify": True}),
                               (("--harmonics", "auto", "--error", 1e-6), {"error": 1e-6}),
                               (("--harmonics", 5, "--near", 1, "--certify"), {"harmonics": 5, "near": 1, "certify": True})):
            with self.subTest(options):
                self.executable("orbit", "find", JENKINS, "--by", "mixed", *flags, "-o", self.folder / "mixed.h5")
                self.assert_same(sm.find_orbit(JENKINS, by="mixed", **options), self.folder / "mixed.h5")
        chosen = sm.find_orbit(JENKINS, by="mixed", error=1e-6)
        self.assertLessEqual(chosen["mixed/relative"], 1e-6)
        self.assertEqual(chosen["mixed/trials"]["harmonics"][-1], chosen["mixed/harmonics"])
        self.assertEqual(chosen["mixed/near"], ["x5", "x10"])
        self.assertEqual(chosen.kind, "orbit")

    def test_sweep_of_full_and_reduced(self):
        scene = sm.Scene.load(CHAIN, set=QUICK)
        rom = sm.reduce(scene, sm.pod(sm.ensemble(scene)), modes=3)
        rom.save(self.folder / "rom.h5")
        speeds = [0.5, 0.4, 0.3]
        for model, word in (("full", "full"), (rom, f"rom:{self.folder / 'rom.h5'}")):
            with self.subTest(word):
                self.executable("sweep", CHAIN, "--over", "drive.speed=0.5:0.3:0.1", "--model", word, "--follow",
                                "-o", self.folder / "sweep.h5", set=QUICK)
                ours = sm.sweep(scene, "drive.speed", speeds, model=model, follow=True)
                self.assert_same(ours, self.folder / "sweep.h5", apart=() if model == "full" else {"provenance/command"})
                table = (ours.full if model == "full" else ours.reduced).values
                np.testing.assert_array_equal(table["parameter"], speeds)
                self.assertEqual(table.dtype.names[:3], ("parameter", "motion", "period"))

    def test_map_and_basins(self):
        self.executable("orbit", "map", BACKLASH, "--over", "drive.omega=1:1.4:0.2", "-o", self.folder / "map.h5")
        self.assert_same(sm.orbit_map(BACKLASH, [("drive.omega", [1.0, 1.2, 1.4])]), self.folder / "map.h5")
        self.executable("orbit", "basins", BACKLASH, "--over", "initial.displacement.0=-2:2:1",
                        "--over", "initial.velocity.0=-1:1:1", "-o", self.folder / "basins.h5")
        ours = sm.basins(BACKLASH, ("initial.displacement.0", np.linspace(-2, 2, 5)),
                         ("initial.velocity.0", np.linspace(-1, 1, 3)))
        self.assert_same(ours, self.folder / "basins.h5")

    def test_exponents_and_verdict(self):
        scene = sm.Scene.load(CHAIN, set=QUICK)
        rom = sm.reduce(scene, sm.pod(sm.ensemble(scene)), modes=2)
        rom.save(self.folder / "rom.h5")
        for flags, options in ((["--exponents", 2], {"exponents": 2}), (["--verdict"], {"verdict": True})):
            with self.subTest(flags):
                self.executable("diagnose", CHAIN, self.folder / "rom.h5", *flags, "-o", self.folder / "their.h5",
                                set=QUICK)
                self.assert_same(sm.exponents(scene, rom, **options), self.folder / "their.h5")

    def test_exponents_over_a_key(self):
        self.executable("diagnose", CHAIN, "--over", "drive.speed=0.1:0.2:0.1", "--exponents", 2, "-o",
                        self.folder / "their.h5", set=QUICK)
        ours = sm.exponent_sweep(sm.Scene.load(CHAIN, set=QUICK), "drive.speed", [0.1, 0.2], exponents=2,
                                 output=self.folder / "ours.h5")
        self.assert_same(ours, self.folder / "their.h5")
        self.assertEqual(ours.exponents.full.values["parameter"].tolist(), [0.1, 0.2])

    def test_the_pipeline_leaves_its_files(self):
        scene = sm.Scene.load(CHAIN, set=QUICK)
        names = sm.run(scene, self.folder / "out")
        self.assertLessEqual({"trajectory.h5", "ensemble.h5", "pod.h5", "validation.h5"}, set(names))
        for name in names:
            self.assertTrue((self.folder / "out" / name).exists() or (self.folder / "out" / f"{name}.svg").exists(), name)

    def test_a_file_of_another_program_reads(self):
        with h5py.File(self.folder / "own.h5", "w") as file:
            file["a/b"] = np.arange(6.0).reshape(2, 3)
            file["a/b"].attrs["units"] = "m"
            file["a/nothing"] = h5py.Empty("f8")
            file["a/no_text"] = h5py.Empty(h5py.string_dtype(length=4))
        own = sm.read(self.folder / "own.h5")
        self.assertEqual(own.kind, "")
        np.testing.assert_array_equal(own["a/b"], [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]])
        self.assertEqual(own.unit("a/b"), "m")
        self.assertEqual(own._store.names(), ["a/b"])  # what has no value is left out
        with self.assertRaisesRegex(sm.InvalidInput, "copy the file"):
            own.save(self.folder / "again.h5")
        (self.folder / "own.h5").write_bytes(b"no")
        with self.assertRaisesRegex(sm.InvalidInput, "not an HDF5 file"):
            sm.read(self.folder / "own.h5")


# Three masses between free ends: a study takes a second.
FREE = {
    "title": "free ends", "units": "dimensionless",
    "structure": {"kind": "chain", "masses": 3, "stiffness": 1.0, "ground_stiffness": 0.3, "damping": 0.01,
                  "ends": "free-free"},
    "contact": [{"at": 2, "law": "stribeck", "mu_s": 0.4, "mu_k": 0.2, "alpha": 5.0, "normal_load": 2.0}],
    "drive": {"kind": "belt", "speed": 0.2},
    "time": {"duration": 300.0, "transient": 100.0, "sample": 0.5},
    "ensemble": {"members": 3, "seed": 7, "spread": 0.1},
    "reduction": {"basis": "pom", "energy": 0.99},
    "validation": {"speeds": {"from": 0.4, "to": 0.2, "step": 0.05}, "transient": 100.0, "block": 400.0, "limit": 800.0,
                   "sweep_limit": 800.0, "horizon": 10.0, "horizon_starts": 2, "orbits": [0.3],
                   "lyapunov_duration": 400.0, "cost_duration": 100.0, "cost_repeats": 1},
}


class Trades(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.scene = self.folder / "free.toml"
        self.scene.write_text(sm.Scene.load(FREE).toml())

    def executable(self, verb, *options):
        done = subprocess.run([EXECUTABLE, verb, self.scene, *options, "--json", "--quiet"], capture_output=True,
                              text=True, check=True)
        return json.loads(done.stdout)

    def assert_measured_alike(self, rows, candidates):
        """What no clock decides: names, errors, scatter, to the last bit."""
        self.assertEqual(list(rows["name"][1:]), [one["name"] for one in candidates])
        for measure in ("dX", "dE", "points", "spread", "energy", "stick"):
            for column, key in ((measure, "error_percent"), (f"{measure}_noise", "noise_percent")):
                theirs = [np.nan if one[key][measure] is None else one[key][measure] for one in candidates]
                np.testing.assert_array_equal(rows[column][1:], theirs, err_msg=column)

    def test_trade_measures_what_the_executable_does(self):
        theirs = self.executable("trade", "--axes", "modes,flow", "--error", "5%")
        ours = sm.trade(self.scene, axes=["modes", "flow"], error="5%", output=self.folder / "trade.h5")
        self.assert_measured_alike(ours.rows, theirs["trade"]["candidates"])
        self.assertEqual(len(ours["trade/recommendations"]), 6)
        self.assertEqual(ours["trade/reference"], theirs["trade"]["reference"]["name"])
        picked = ours.rows[ours.rows["name"] == ours["trade/choice/name"]]
        self.assertLessEqual(picked["dE"][0], 5.0)
        self.assertIn("for dE under 5 % use", ours["trade/choice/sentence"])
        self.assertIsInstance(ours.chosen, sm.Scene)
        text = repr(ours)
        self.assertIn("dE [%]", text)
        for name in ours.rows["name"]:
            self.assertIn(f"\n{name}  ", text)
        self.assertIn("<td>", ours._repr_html_())
        self.assertIsInstance(sm.read(self.folder / "trade.h5"), sm.Trade)
        self.assertEqual(list(sm.read(self.folder / "trade.h5").rows["dE"]), list(ours.rows["dE"]))

    def test_ways_to_the_orbit_are_the_executables(self):
        done = subprocess.run([EXECUTABLE, "trade", JENKINS, "--axes", "harmonics,samples,mixed", "--json", "--quiet"],
                              capture_output=True, text=True, check=True)
        theirs = json.loads(done.stdout)["orbits"]
        ours = sm.trade(JENKINS, axes=["harmonics", "samples", "mixed"])
        self.assertEqual(list(ours.orbits["name"][1:]), [row["name"] for row in theirs["rows"]])
        self.assertEqual(list(ours.orbits["options"][1:]), [row["options"] for row in theirs["rows"]])
        np.testing.assert_array_equal(
            ours.orbits["error"][1:],
            [np.nan if row["error_percent"] is None else row["error_percent"] for row in theirs["rows"]])
        self.assertEqual(ours["trade/regimes"], theirs["regimes"])
        self.assertIn("\nmixed, 9 harmonics  ", repr(ours))
        self.assertIn("trade/orbits/name", ours)
        self.assertNotIn("trade/orbits/name", sm.trade(self.scene, axes="flow"))

    def test_what_nothing_keeps_to_says_so_and_gives_the_rows(self):
        done = sm.trade(self.scene, axes="flow", budget="0.0001ms")
        self.assertGreater(len(done.rows), 5)
        with self.assertRaisesRegex(sm.InvalidInput, "the cheapest that exists: "):
            done.chosen
        self.assertIn("the cheapest that exists: ", str(done))
        with self.assertRaisesRegex(sm.InvalidInput, "give error or budget"):
            sm.trade(self.scene, axes="flow").chosen

    def test_advice_is_the_executables(self):
        theirs = self.executable("advise", "--question", "statistics", "--error", "5%")
        ours = sm.advise(self.scene, question="statistics", error=5)
        self.assert_measured_alike(ours["trade/candidates"], theirs["study"]["candidates"])
        self.assertEqual([(row["effect"], row["verdict"], row["measure"]) for row in ours.rows],
                         [(one["effect"], one["verdict"], one["measure"]) for one in theirs["effects"]])
        np.testing.assert_array_equal(ours.rows["error"], [one["error_percent"] for one in theirs["effects"]])
        self.assertEqual([(row["effect"], bool(row["left_out"])) for row in ours["advice/steps"]],
                         [(one["effect"], one["left_out"]) for one in theirs["steps"]])
        self.assertEqual(ours["advice/left_out"], theirs["lean"]["left_out"])
        self.assertEqual(ours.lean.get("flow.tolerance"), 1e-3)
        self.assertTrue(ours.sentences.startswith("The motion is "))
        self.assertIn("static friction peak", repr(ours))

    def test_an_interrupted_trade_goes_on_in_the_executable(self):
        changes = {"validation.limit": 4e4, "validation.block": 4e4}
        for verb in ("trade", "advise"):
            with self.subTest(verb):
                output = self.folder / f"{verb}.h5"
                journal = pathlib.Path(f"{output}.journal")
                others = []

                def interrupt():
                    while not journal.exists() or journal.stat().st_size < 500:
                        others.append(time.sleep(1e-3))  # beside the study: it does not hold Python's lock
                    os.kill(os.getpid(), signal.SIGINT)

                thread = threading.Thread(target=interrupt)
                with self.assertRaises(KeyboardInterrupt):
                    thread.start()
                    getattr(sm, verb)(sm.Scene.load(self.scene, set=changes), output=output, threads=1)
                thread.join()
                self.assertGreater(len(others), 10)
                self.assertTrue(journal.exists() and not output.exists())
                options = [word for key, value in changes.items() for word in ("--set", f"{key}={value!r}")]
                self.assertGreater(self.executable(verb, "-o", output, *options)["resumed"], 0)
                self.assertTrue(output.exists() and not journal.exists())


class KnownValues(unittest.TestCase):
    def test_multipliers_of_a_linear_oscillator(self):
        # In the gap the mass is free but for c = 0.05: multipliers 1 and exp(-c T), T = 2 pi / 1.4.
        orbit = sm.find_orbit(BACKLASH)
        self.assertEqual(orbit.multipliers.dtype, complex)
        np.testing.assert_allclose(orbit.multipliers, [1.0, np.exp(-0.05 * 2.0 * np.pi / 1.4)], rtol=1e-10)

    def test_an_orbit_that_is_not_found_says_how_far_it_came(self):
        with self.assertRaises(sm.NumericalFailure) as caught:
            sm.find_orbit(BACKLASH, start=[2.5, 0.0], order=7, iterations=1)
        self.assertEqual(caught.exception.state.shape, (2,))
        self.assertGreater(caught.exception.residual, 0.0)

    def test_a_balance_has_its_orbits_coefficients(self):
        # What a series of order 9, 21, 49 leaves out: 2e-5, 5e-7, 5e-9 of the orbit's own first cosine.
        exact = sm.spectrum(sm.find_orbit(PLAY, start=[2.5, 0.0]), harmonics=1)["spectrum/coefficients"]
        for order, apart in ((9, 3e-5), (21, 1e-6), (49, 1e-8)):
            balance = sm.find_orbit(PLAY, by="balance", harmonics=order, certify=True)
            self.assertAlmostEqual(balance["balance/coefficients"]["displacement_1_cosine"][1],
                                   exact["displacement_1_cosine"][1], delta=apart)

    def test_a_branch_of_balances_that_is_lost_says_so_and_keeps_what_was_found(self):
        with self.assertRaisesRegex(sm.NumericalFailure, "lost") as caught:
            sm.continue_orbit(PLAY, over="drive.omega", from_=1.0, to=0.05, by="balance", harmonics=3, step=0.3,
                              max_step=0.3, sequential=True)
        self.assertEqual(caught.exception.result.kind, "branches")

    def test_a_balance_that_is_not_found(self):
        with self.assertRaisesRegex(sm.NumericalFailure, "not met"):
            sm.find_orbit(PLAY, by="balance", error=1e-300)

    def test_a_mixed_orbit_that_does_not_meet_the_error_says_how_near_it_came(self):
        with self.assertRaisesRegex(sm.NumericalFailure, "not met up to 175 harmonics: the least is") as caught:
            sm.find_orbit(STOP, by="mixed", error=1e-300)
        self.assertLess(caught.exception.result["mixed/relative"], 1e-12)

    def test_all_modes_of_a_basis_move_as_the_full_model(self):
        scene = sm.Scene.load(CHAIN, set=SHORT)
        rom = sm.reduce(scene, "lnm", modes=4)
        full = sm.find_orbit(sm.Scene.load(scene, set={"drive.speed": 0.5}))
        same = sm.find_orbit(sm.Scene.load(scene, set={"drive.speed": 0.5}), model=rom)
        self.assertAlmostEqual(full.period, same.period, delta=1e-9 * full.period)
        brief = sm.Scene.load(scene, set={"time.duration": 20.0, "time.transient": 0.0})
        np.testing.assert_allclose(sm.simulate(brief, model=rom).q, sm.simulate(brief).q, atol=1e-9)


class Elsewhere(unittest.TestCase):
    def test_results_become_xarrays_with_units_and_shared_dimensions(self):
        scene = sm.Scene.load(CHAIN, set=SHORT)
        run = sm.simulate(scene)
        data = run.to_xarray()
        self.assertEqual(data["trajectory/q"].dims, ("trajectory/time", "trajectory/dof"))
        np.testing.assert_array_equal(data["trajectory/q"], run.q)
        self.assertIn("trajectory/time", data.coords)
        self.assertEqual(data["trajectory/events/kind"].dims, data["trajectory/events/force"].dims)
        self.assertEqual(data.attrs["kind"], "trajectory")
        for result in (sm.pod(run), sm.modes(scene), sm.find_orbit(BACKLASH), sm.sweep(scene, "drive.speed", [0.5, 0.4])):
            arrays = [name for name in result._store.names()
                      if not name.startswith("provenance/") and np.ndim(result[name]) > 0]
            self.assertEqual(sorted(result.to_xarray().variables), sorted(arrays))

    def test_a_bar_is_closed_when_its_part_ends_begins_anew_or_the_call_is_left(self):
        import tqdm

        made = []

        def bar(**options):
            made.append(tqdm.tqdm(file=io.StringIO(), **options))
            return made[-1]

        with sm._Bars(bar) as bars:
            for done in (5, 10, 5, 10, 2):  # the same part and total three times, the last not to its end
                bars("part", done, 10)
        self.assertEqual([one.n for one in made], [10, 10, 2])
        self.assertTrue(all(one.disable for one in made))  # as tqdm marks what was closed

    def test_figures_name_what_they_show(self):
        import matplotlib

        matplotlib.use("Agg")
        run = sm.simulate(sm.Scene.load(CHAIN, set=SHORT))
        axes = run.plot()
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("time", "q"))
        np.testing.assert_array_equal(axes.lines[3].get_ydata(), run.q[:, 3])
        with self.assertRaisesRegex(sm.InvalidInput, "two of its names"):
            sm.modes(CHAIN).plot()


class Refused(unittest.TestCase):
    def test_an_output_that_cannot_be_written_before_anything_is_computed(self):
        scene = sm.Scene.load(CHAIN, set={"validation.sweep_limit": 1e10, "validation.transient": 9e9})  # hours
        with tempfile.TemporaryDirectory() as folder:
            for output, words in ((folder, "is a folder"), (f"{folder}/", "is a folder"),
                                  (f"{folder}/none/sweep.h5", "does not exist")):
                for call in (lambda: sm.sweep(scene, "drive.speed", [0.1], output=output),
                             lambda: sm.validate(scene, sm.modes(scene), output=output),
                             lambda: sm.orbit_map(BACKLASH, [("drive.omega", [1.0])], output=output),
                             lambda: sm.basins(BACKLASH, ("initial.displacement.0", [0.0]),
                                               ("initial.velocity.0", [0.0]), output=output)):
                    with self.subTest(output), self.assertRaisesRegex(sm.InvalidInput, words):
                        call()

    def test_what_a_study_cannot_take(self):
        scene = sm.Scene.load(CHAIN, set=SHORT)
        for call, words in (
                (lambda: sm.reduce(scene, "lnm"), "energy shares"),
                (lambda: sm.reduce(scene, sm.modes(scene), modes=2), "natural modes"),
                (lambda: sm.pod(sm.modes(scene)), "ensemble"),
                (lambda: sm.pod(3), "^motion: 3: expected a result of simulate"),
                (lambda: sm.reduce(scene, 3), "^basis: 3: expected a result of pod"),
                (lambda: sm.reduce(scene, np.eye(4)[0]), "two, dof x mode"),
                (lambda: sm.reduce(scene, np.eye(3)), "3 x 3"),
                (lambda: sm.reduce(scene, np.ones((4, 2))), "reduce"),
                (lambda: sm.validate(scene, sm.simulate(BACKLASH)), "degrees of freedom"),
                (lambda: sm.find_orbit(scene, start="there"), "settle"),
                (lambda: sm.find_orbit(scene, start=[0.0]), "4 displacements"),
                (lambda: sm.find_orbit(BACKLASH, start=[np.nan, 0.0]), "1 displacements"),
                (lambda: sm.find_orbit(scene, tolerance=0.0), "> 0"),
                (lambda: sm.run(scene, "/proc/none"), "a folder that can be made"),
                (lambda: sm.sweep(scene, "drive.speed", []), "at least one"),
                (lambda: sm.orbit_map(BACKLASH, [("drive.omega", [1.0])], starts=[]), "starts: found none"),
                (lambda: sm.reduce(scene, "lnm", modes=-1), "^modes = -1: expected 1 or more"),
                (lambda: sm.pod(sm.ensemble(scene), modes=-1), "^modes = -1: expected 1 or more"),
                (lambda: sm.modes(scene, count=5), "^count = 5: expected"),
                (lambda: sm.exponents(scene, scene), "results of pod"),
                (lambda: sm.find_orbit(scene, model=3), "reduce"),
                (lambda: sm.continue_orbit(BACKLASH, over="drive.omega", to=1.4), "no length"),
                (lambda: sm.find_orbit(BACKLASH, by="guess"), "shooting"),
                (lambda: sm.find_orbit(BACKLASH, harmonics=9), "valid:"),
                (lambda: sm.find_orbit(BACKLASH, by="balance", harmonics=0), "from 1 on, or auto"),
                (lambda: sm.find_orbit(BACKLASH, by="balance", samples=3, harmonics=9), "more than 18"),
                (lambda: sm.find_orbit(BACKLASH, by="balance", start=[1.0, 0.0]), "contact"),
                (lambda: sm.find_orbit(scene, by="balance"), "balance"),
                (lambda: sm.find_orbit(JENKINS, by="mixed"), "certify=True"),
                (lambda: sm.trade(scene, axes=["modes", "colour"]), "no axis 'colour'; valid: modes"),
                (lambda: sm.trade(scene, error="much"), "expected a share in percent"),
                (lambda: sm.trade(scene, budget=-1), "expected a time in s"),
                (lambda: sm.trade(scene, product=1), "True or False"),
                (lambda: sm.trade(scene, modes=3), "valid: axes, product, measure, error, budget"),
                (lambda: sm.advise(scene, question="colour"), "valid: motion, statistics"),
                (lambda: sm.advise(scene, question="motion", measure="energy"), "answers the question statistics"),
                (lambda: sm.advise(scene, error=True), "a number or a word"),
                (lambda: sm.find_orbit(JENKINS, by="mixed", samples=64), "samples"),
                (lambda: sm.find_orbit(JENKINS, by="mixed", near=-1), "near = -1"),
                (lambda: sm.find_orbit(JENKINS, by="other"), "shooting, balance, mixed"),
                (lambda: sm.continue_orbit(JENKINS, over="drive.omega", to=1.0, by="mixed"), "shooting, balance"),
                (lambda: sm.continue_orbit(BACKLASH, over="drive.omega", to=1.1, by="balance", switch=True), "shooting"),
                (lambda: sm.find_orbit(BACKLASH, by="balance", harmonics=True), "a number or a word"),
                (lambda: sm.continue_orbit(BACKLASH, over="drive.omega", to=1.1, by="balance", every=5), "certify"),
                (lambda: sm.spectrum(sm.modes(scene)), "orbit"),
                (lambda: sm.spectrum(sm.find_orbit(BACKLASH), dofs=[2]), "1 to 1"),
                (lambda: sm.skeleton(scene, compare=True), "add model"),
                (lambda: sm.skeleton(scene, radius=0), "> 0"),
                (lambda: sm.sweep(scene, "drive.sped", [0.1]), "drive"),
                (lambda: sm.sweep(scene, "structure.masses", [4, 5]), "degrees of freedom"),
                (lambda: sm.sweep(scene, "drive.speed", [0.1], folow=True), "valid: .*follow"),
                (lambda: sm.basins(PLAY, ("drive.omega", [1.0]), ("initial.velocity.0", [0.0])), "initial")):
            with self.subTest(words), self.assertRaisesRegex(sm.InvalidInput, words):
                call()


class GoesOn(unittest.TestCase):
    def test_an_interrupted_sweep_is_taken_up_from_its_file(self):
        changes = {**SHORT, "validation.transient": 2000.0, "validation.sweep_limit": 20000.0,
                   "validation.block": 1000.0}
        scene = sm.Scene.load(CHAIN, set=changes)
        speeds = sm.values(0.1, 0.5, 0.002)
        with tempfile.TemporaryDirectory() as folder:
            output = pathlib.Path(folder) / "sweep.h5"
            journal = pathlib.Path(f"{output}.journal")

            def interrupt():
                while not journal.exists() or journal.stat().st_size < 4000:  # some values of the 201
                    time.sleep(1e-3)
                os.kill(os.getpid(), signal.SIGINT)

            thread = threading.Thread(target=interrupt)
            with self.assertRaises(KeyboardInterrupt):
                thread.start()
                sm.sweep(scene, "drive.speed", speeds, output=output)
            thread.join()
            self.assertEqual([path.name for path in output.parent.iterdir()], ["sweep.h5.journal"])
            theirs = pathlib.Path(folder + "_theirs")
            self.addCleanup(shutil.rmtree, theirs)
            shutil.copytree(folder, theirs)
            few = sm.sweep(scene, "drive.speed", speeds, output=output)
            self.assertEqual([path.name for path in output.parent.iterdir()], ["sweep.h5"])
            # The executable takes it up from the same journal.
            said = subprocess.run(
                [EXECUTABLE, "sweep", CHAIN, "--over", "drive.speed=0.1:0.5:0.002", "-o", theirs / "sweep.h5",
                 *(word for key, value in changes.items() for word in ("--set", f"{key}={value!r}"))],
                capture_output=True, text=True, check=True)
            self.assertIn("taken over from an interrupted run", said.stdout)
            self.assertEqual(output.read_bytes(), (theirs / "sweep.h5").read_bytes())
            again = sm.read(output)
            self.assertEqual(sorted(again._store.names()), sorted(few._store.names()))
        fresh = sm.sweep(scene, "drive.speed", speeds)
        for name in fresh._store.names():
            np.testing.assert_array_equal(few[name], fresh[name], err_msg=name)


if __name__ == "__main__":
    unittest.main()
