"""Figures of results by matplotlib: those that the executable draws of the same file, with its numbers."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import slipmode as sm

EXECUTABLE = os.environ["SLIPMODE_EXECUTABLE"]
DATASETS = pathlib.Path(os.environ["SLIPMODE_SOURCE_DIR"]) / "datasets"
SHORT = {"time.duration": 600.0, "time.transient": 300.0}


def results():
    """One of many kinds, by its name."""
    chain = sm.Scene.load(DATASETS / "chain10/scene.toml", set=SHORT)
    backlash = sm.Scene.load(DATASETS / "backlash_sdof/scene.toml")
    run = sm.simulate(chain)
    basis = sm.pod(run)
    return {"run": run, "pod": basis, "rom": sm.reduce(chain, basis, modes=4), "modes": sm.modes(chain),
            "sweep": sm.sweep(chain, "drive.speed", [0.1, 0.2, 0.3]), "orbit": sm.find_orbit(backlash),
            "branch": sm.continue_orbit(backlash, "drive.omega", 1.3, points=20),
            "basins": sm.basins(backlash, *((f"initial.{name}.0", np.linspace(-2.0, 2.0, 5))
                                            for name in ("displacement", "velocity"))),
            "diagnosis": sm.diagnose(np.sin(0.3 * np.arange(3000.0)), interval=0.1)}


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.results = results()

    def test_they_are_those_of_the_executable(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, result in self.results.items():
                with self.subTest(name):
                    file = pathlib.Path(folder) / f"{name}.h5"
                    result.save(file)
                    refused = subprocess.run([EXECUTABLE, "plot", file, "--figure", "?", "-o", f"{folder}/x.svg"],
                                             capture_output=True, text=True)
                    figures = result.figures()
                    self.assertEqual(", ".join(figures), refused.stderr.strip().partition(" can give ")[2])
                    for figure in figures.values():
                        figure.savefig(f"{folder}/ours.png")

    def test_curves_have_the_numbers_of_the_result(self):
        run = self.results["run"]
        portrait = run.figures()["portrait"].axes[0]
        x, v = portrait.lines[-1].get_data()
        self.assertTrue(set(x) <= set(run.contact_q[:, 0]) and set(v) <= set(run.contact_v[:, 0]))
        self.assertGreater(len(x), 100)
        self.assertRegex(portrait.get_xlabel(), r"displacement .*\$_\{\\mathregular\{10\}\}\$")

    def test_a_notebook_shows_the_table_and_the_figures(self):
        for name in ("run", "branch", "basins"):
            page = self.results[name]._repr_html_()
            self.assertIn("<table>", page)
            self.assertIn('src="data:image/png;base64,', page)


if __name__ == "__main__":
    unittest.main()
