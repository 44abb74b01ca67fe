"""What editors and type checkers are told: signatures with the options that studies take, and the stub made of them."""

import ast
import inspect
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import slipmode as sm

STUB = pathlib.Path(sm.__file__).with_suffix(".pyi")
if not STUB.exists():  # beside the extension, where the package itself is a link
    STUB = pathlib.Path(sys.modules["slipmode._slipmode"].__file__).parent / "__init__.pyi"

BELT = {
    "units": "dimensionless",
    "structure": {"kind": "masses", "mass": 1.0, "link": [{"at": 1, "stiffness": 1.0}]},
    "contact": [{"at": 1, "law": "coulomb", "mu_s": 0.3, "mu_k": 0.3, "normal_load": 1.0}],
    "drive": {"kind": "belt", "speed": 2.0},
    "time": {"duration": 10.0, "sample": 0.01},
}
PUSHED = BELT | {"drive": {"kind": "force", "omega": 0.7, "amplitude": 1.0, "at": 1}, "time": {"cycles": 10}}


def studies():
    """Each study with arguments it would take, and options without which it does not read all of its others."""
    run = sm.simulate(BELT | {"initial": {"displacement": [0.5], "velocity": [0.0]}})
    key, plane = ("drive.omega", [0.5, 0.6]), (("initial.displacement.0", [0.0, 1.0]), ("initial.velocity.0", [0.0, 1.0]))
    return [(sm.simulate, (BELT,), {}), (sm.ensemble, (BELT,), {}), (sm.validate, (BELT, sm.pod(run)), {}),
            (sm.find_orbit, (PUSHED,), {"by": "balance"}), (sm.continue_orbit, (PUSHED, "drive.omega", 0.8), {"by": "balance"}),
            (sm.skeleton, (BELT,), {}), (sm.sweep, (BELT, "drive.speed", [0.5, 0.6]), {}), (sm.orbit_map, (PUSHED, [key]), {}),
            (sm.basins, (PUSHED, *plane), {}), (sm.exponents, (BELT,), {}),
            (sm.exponent_sweep, (BELT, "drive.speed", [0.5, 0.6]), {}), (sm.trade, (BELT,), {}), (sm.advise, (BELT,), {}),
            (sm.diagnose, (np.sin(np.arange(200.0)),), {"interval": 0.1}),
            (sm.spectrum, (sm.find_orbit(PUSHED, settle=50.0),), {}), (sm.run, (BELT, tempfile.gettempdir()), {})]


class Signatures(unittest.TestCase):
    def test_they_have_the_options_that_are_taken_with_their_defaults(self):
        for study, arguments, needed in studies():
            left = list(inspect.signature(study).parameters.values())[len(arguments):]
            given = {one.name: one.default for one in left if one.kind != one.VAR_POSITIONAL} | needed
            with self.subTest(study.__name__), self.assertRaises(sm.InvalidInput) as refused:
                study(*arguments, **given, no_such=1)
            words = str(refused.exception)  # of what is left over the first is named
            self.assertIn("no_such = 1: no such option", words)
            self.assertLessEqual(set(words.partition("valid: ")[2].split(", ")), given.keys())

    def test_types_and_defaults_are_those_of_the_fields(self):
        shown = str(inspect.signature(sm.sweep))
        for part in ("over: str, values: npt.ArrayLike, *", "model: str | Result = 'full'", "segments: int = 1",
                     "follow: bool = False", "lyapunov: float = 0.0", "output: str | None = None", "-> Result"):
            self.assertIn(part, shown)
        self.assertIn("*bases: Result", str(inspect.signature(sm.exponents)))
        self.assertIn("axes: str | list[str] | None = None, *", str(inspect.signature(sm.trade)))

    def test_a_word_of_python_as_an_option_ends_in_an_underscore(self):
        record = np.sin(0.3 * np.arange(2000.0))
        late, all_of_it = (sm.diagnose(record, interval=0.1, tools=["information"], **own) for own in ({"from_": 100.0}, {}))
        self.assertEqual((len(all_of_it.values), len(late.values)), (2000, 1000))


class Stub(unittest.TestCase):
    def test_it_has_every_public_name(self):
        named = {node.name for node in ast.parse(STUB.read_text()).body if hasattr(node, "name")}
        public = {name for name, value in vars(sm).items()
                  if not name.startswith("_") and name != "annotations" and not inspect.ismodule(value)}
        self.assertEqual(named - {"_Branch"}, public)
        self.assertTrue(STUB.with_name("py.typed").exists())

    @unittest.skipUnless(shutil.which("mypy"), "no mypy here")
    def test_mypy_passes_what_is_right_and_names_what_is_not(self):
        with tempfile.TemporaryDirectory() as folder:
            package = pathlib.Path(folder) / "slipmode"
            package.mkdir()
            for name in ("__init__.pyi", "py.typed"):
                shutil.copy(STUB.with_name(name), package / name)
            program = pathlib.Path(folder) / "program.py"
            program.write_text('import slipmode as sm\n'
                               'scene = sm.Scene.load("scene.toml", set={"drive.speed": 0.25})\n'
                               'run = sm.simulate(scene, threads=1)\n'
                               'print(run.t, run.q, run.audit, run.scene.size, run.kind.upper())\n'
                               'rom = sm.reduce(scene, sm.pod(run), modes=6)\n'
                               'sm.sweep(scene, "drive.speed", [0.1, 0.2], model=rom, follow=True)\n'
                               'sm.trade(scene, ["modes"], error="1%").chosen.set(drive__speed=0.3)\n'
                               'try:\n    pass\nexcept sm.NumericalFailure as failure:\n    print(failure.time)\n'
                               'sm.sweep(scene, "drive.speed", [0.1], segmants=2)\n'
                               'sm.simulate(scene, threads="two")\n')
            done = subprocess.run(["mypy", "--cache-dir", f"{folder}/cache", program.name], cwd=folder, capture_output=True,
                                  text=True)
            wrong = [line.split(":")[1] for line in done.stdout.splitlines() if ": error: " in line]
            self.assertEqual(wrong, ["12", "13"], done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
