"""The schema of scenes beside the reader of scenes: what the reader takes is valid; what only one key says, both refuse."""

import copy
import json
import os
import pathlib
import subprocess
import unittest

import slipmode as sm

try:
    import jsonschema
    import tomllib
except ImportError as missing:
    jsonschema = None
    LACKS = f"{missing}; apt-get install python3-jsonschema, and Python 3.11 or later"
else:
    LACKS = ""

EXECUTABLE = os.environ["SLIPMODE_EXECUTABLE"]
DATASETS = pathlib.Path(os.environ["SLIPMODE_SOURCE_DIR"]) / "datasets"

# What the scenes that ship leave out: each key of it stands in one of these.
MORE = {
    "units": "SI",
    "structure": {"kind": "beam", "theory": "timoshenko", "span": [
        {"length": 0.2, "width": 0.02, "thickness": 0.002, "youngs_modulus": 2e11, "density": 7850.0, "elements": 4,
         "poisson_ratio": 0.3},
        {"length": 0.1, "width": 0.02, "thickness": 0.001, "youngs_modulus": 2e11, "density": 7850.0, "elements": 2}],
        "damping": {"ratio": [0.01, 0.02], "frequency": [10.0, 50.0]}},
    "contact": [
        {"at": 0.25, "law": "coulomb", "mu_s": 0.4, "mu_k": 0.3, "tilt_deg": 1.0, "normal_load": {
            "constant": 1.0, "oscillator": {"mass": 0.1, "support_stiffness": 100.0, "spring_stiffness": 10.0,
                                            "slope": 0.01}}},
        {"at": "tip", "law": "lugre", "mu_s": 0.4, "mu_k": 0.3, "stribeck_speed": 0.01, "stiffness": 1e4,
         "normal_load": 1}],
    "drive": {"kind": "shaker", "frequency": 12, "amplitude": {"table": [[5, 1e-3], [60, 2e-3]]}},
    "flow": {"method": "collocation", "tolerance": 1e-8, "certify": False},
}
LAWS = {
    "units": "dimensionless",
    "structure": {"kind": "chain", "masses": 4, "mass": [1, 1, 1, 2], "ground_stiffness": 0.1, "ends": "free-free"},
    "contact": [
        {"at": 1, "law": "table", "mu_s": 0.5, "speeds": [0, 1], "coefficients": [0.4, 0.3], "normal_load": 1},
        {"at": 2, "law": "tanh", "mu_s": 0.5, "mu_k": 0.4, "normal_load": 1},
        {"at": 3, "law": "dahl", "mu": 0.5, "stiffness": 10.0, "normal_load": 1},
        {"between": [3, 4], "law": "clearance", "left": {"stiffness": 2.0, "gap": 1.0}}],
    "drive": {"kind": "belt", "speed": {"from": 0.1, "to": 0.2, "begin": 10, "end": 20}},
    "time": {"transient": 10},
}


def scenes():
    """All that ship, those of `slipmode new`, and the two above, by name."""
    found = {str(path): tomllib.loads(path.read_text()) for path in sorted(DATASETS.glob("*/scene.toml"))}
    for kind in ("chain", "beam", "matrices", "clearance"):
        found[kind] = tomllib.loads(printed("new", kind))
    return {**found, "more": MORE, "laws": LAWS}


def printed(*arguments):
    return subprocess.run([EXECUTABLE, *arguments], capture_output=True, text=True, check=True).stdout


def is_read(scene):
    try:
        sm.Scene.load(scene)
        return True
    except sm.InvalidInput:
        return False


def tables(value, path=()):
    """Every table in a scene, by the keys that lead there."""
    if isinstance(value, dict):
        yield path
    for key, item in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from tables(item, (*path, key))


def changed(scene, path, change):
    """A copy with one of its tables changed."""
    scene = copy.deepcopy(scene)
    table = scene
    for key in path:
        table = table[key]
    change(table)
    return scene


@unittest.skipIf(LACKS, LACKS)
class Schema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        schema = json.loads(printed("schema"))
        jsonschema.Draft7Validator.check_schema(schema)
        cls.validator = jsonschema.Draft7Validator(schema)

    def test_every_scene_is_valid_as_it_is_and_written_out_in_full(self):
        for name, scene in scenes().items():
            self.assertTrue(is_read(scene), name)
            self.assertEqual([error.message for error in self.validator.iter_errors(scene)], [], name)
            full = tomllib.loads(sm.Scene.load(scene).toml())
            self.assertEqual([error.message for error in self.validator.iter_errors(full)], [], name)

    def test_an_unknown_key_is_refused_in_every_table(self):
        for name, scene in scenes().items():
            for path in tables(scene):
                bad = changed(scene, path, lambda table: table.update(colour="red"))
                self.assertFalse(is_read(bad), (name, path))
                self.assertFalse(self.validator.is_valid(bad), (name, path))

    def test_what_the_reader_takes_is_valid_whatever_key_is_left_out_or_has_another_value(self):
        refused = 0
        for name, scene in scenes().items():
            for path in tables(scene):
                table = scene
                for key in path:
                    table = table[key]
                for key in table:
                    changes = [lambda own: own.pop(key)]
                    changes += [lambda own, value=value: own.update({key: value}) for value in (-1, 0, 2, "word", [], True)]
                    for change in changes:
                        bad = changed(scene, path, change)
                        if not self.validator.is_valid(bad):
                            refused += 1
                            self.assertFalse(is_read(bad), (name, path, key, "valid to the reader, not to the schema"))
        self.assertGreater(refused, 1000)

    def test_values_beyond_a_limit_and_words_that_there_are_not_are_refused(self):
        chain = tomllib.loads((DATASETS / "chain10/scene.toml").read_text())
        beam = tomllib.loads((DATASETS / "beam_12hz/scene.toml").read_text())
        for scene, path, key, value in (
                (chain, ("structure",), "masses", 0), (chain, ("structure",), "masses", 1.5),
                (chain, ("structure",), "stiffness", -1.0), (chain, ("structure",), "ends", "fixed-fred"),
                (chain, ("contact", 0), "law", "coulomn"), (chain, ("contact", 0), "mu_s", -0.1),
                (chain, ("contact", 0), "normal_load", 0.0), (chain, ("drive",), "kind", "motor"),
                (chain, ("reduction",), "energy", 1.5), (chain, ("reduction",), "basis", "pod"),
                (chain, ("validation",), "cycles", 10), (chain, (), "units", "si"),
                (beam, ("structure", "damping"), "ratio", 0.1), (beam, ("drive", "amplitude"), "exponential", {"at": 1}),
                (beam, ("sensors",), "kind", "acceleration"), (beam, ("time",), "samples_per_cycle", 0)):
            bad = changed(scene, path, lambda table: table.update({key: value}))
            self.assertFalse(is_read(bad), (path, key, value))
            self.assertFalse(self.validator.is_valid(bad), (path, key, value))


if __name__ == "__main__":
    unittest.main()
