"""The report's page in real Chromium: what clicks, sliders and keys do, and that hostile names stay text."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import chromium

EXECUTABLE = os.environ["SLIPMODE_EXECUTABLE"]

# Four masses on a belt: runs in a second. The title tries to break out of every place it is written to.
HOSTILE = """</title></script><script>window.broken = 1</script><img src=x onerror='window.broken = 2'>&amp;"""
SCENE = f"""
title = '''{HOSTILE}'''
units = "dimensionless"
[structure]
kind = "chain"
masses = 4
damping = 0.05
[[contact]]
at = 4
name = "<b>brake</b>"
law = "stribeck"
alpha = 2.0
mu_s = 0.4
mu_k = 0.2
normal_load = 3.0
[drive]
kind = "belt"
speed = 0.3
[time]
duration = 400.0
transient = 100.0
[initial]
at = "static"
[ensemble]
members = 2
spread = 0.1
[reduction]
modes = 2
[validation]
speeds = {{ from = 0.5, to = 0.1, step = 0.1 }}
transient = 100.0
block = 200.0
limit = 2000.0
sweep_limit = 2000.0
horizon = 50.0
modes = [1, 2, 3, 4]
lyapunov_duration = 500.0
cost_duration = 100.0
"""


def slipmode(*words, folder):
    return subprocess.run([EXECUTABLE, *words], cwd=folder, capture_output=True, text=True, check=True)


@unittest.skipUnless(chromium.executable(), "no Chromium here (Debian: chromium)")
class RunOfAChain(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(cls.folder.name)
        cls.place = root / "a <b>&'\" folder"
        cls.place.mkdir()
        (cls.place / "scene.toml").write_text(SCENE)
        slipmode("run", "scene.toml", "-o", "out", folder=cls.place)
        cls.file = cls.place / "out" / "report.html"
        cls.page = chromium.Page(cls.file)
        cls.page.run("document.querySelector('#play').click()")  # so that nothing moves by itself

    @classmethod
    def tearDownClass(cls):
        complaints, requests = cls.page.complaints, cls.page.requests
        cls.page.close()
        cls.folder.cleanup()
        assert not complaints, complaints
        assert [one for one in requests if not one.startswith(("file:", "data:"))] == [], requests

    def value(self, script):
        return self.page.run(script)

    def slide(self, name, value):
        self.page.run(f"""(() => {{ const own = document.querySelector('#{name}');
          own.value = {value}; own.dispatchEvent(new Event('input')); }})()""")
        self.page.frame()

    def test_hostile_names_stay_text(self):
        self.assertIsNone(self.value("window.broken ?? null"))
        self.assertEqual(self.value("document.title"), HOSTILE)
        self.assertEqual(self.value("document.querySelector('h1').textContent"), HOSTILE)
        self.assertEqual(self.value("document.querySelectorAll('main img, main b').length"), 0)
        self.assertIn("<b>brake</b>", self.value("document.querySelector('.answers').textContent"))

    def test_the_first_screen_answers(self):
        text = self.value("document.querySelector('.answers').textContent")
        for question in ("What was modelled?", "Is the reduced model to be trusted?", "Where?", "What does it save?",
                         "How accurate is it?", "Does the energy balance close?"):
            self.assertIn(question, text)
        self.assertIn("A chain of 4 masses, on a belt at V = 0.3", text)
        self.assertEqual(self.value("document.querySelector('.command code').textContent"),
                         "slipmode run scene.toml -o out")

    def test_a_click_on_a_speed_shows_its_motion(self):
        # The diagram spans the five speeds 0.1 ... 0.5, with a margin of 4 % on either side.
        for share, speed in ((0.04, "0.1"), (0.28, "0.2"), (0.96, "0.5")):
            self.page.click(".full-diagram svg > rect", x=share)
            self.assertEqual(self.value("document.querySelector('#speed').parentNode.querySelector('output').textContent"),
                             speed)
            self.assertIn(f"= {speed}", self.value("document.querySelector('#told').textContent"))

    def test_the_slider_over_modes_moves_the_reduced_model_through_all_figures(self):
        titles = []
        for modes in (1, 2, 3, 4):
            self.slide("modes", modes - 1)
            self.assertIn(f"{modes} POMs", self.value("document.querySelector('#told').textContent"))
            titles.append(self.value("document.querySelector('.reduced-diagram h4').textContent"))
            legends = self.value("[...document.querySelectorAll('#motions .panels svg')].map(s => s.textContent)")
            self.assertEqual(len(legends), 4)
            self.page.run("document.querySelector('#motions .panels').scrollIntoView()")
            self.page.frame()
            for legend in self.value("[...document.querySelectorAll('#motions .panels svg')].map(s => s.textContent)"):
                self.assertIn(f"{modes} POMs", legend)
        self.assertEqual(titles[1], "reduced model, 2 POMs")  # the number chosen: the validation's own sweep
        self.assertIn("computed for this page", titles[0])

    # All modes kept: the reduced model is the full one in other coordinates, so on a periodic motion both are the same.
    def test_with_all_modes_the_motions_coincide(self):
        apart = self.value("""(async () => {
          const own = await documentOf(document.getElementById("motion-data")), last = own.models.length - 1;
          return own.speeds.map((speed, k) => {
            if (!own.models[0].said[k].startsWith("period")) return null;
            const [a, b] = [0, last].map(m => list(own.models[m].motions[k].q));
            const size = d3.max(a) - d3.min(a);
            return d3.max(a.map((value, i) => Math.abs(value - b[i]))) / size;
          });
        })()""")
        compared = [one for one in apart if one is not None]
        self.assertTrue(compared)
        for one in compared:
            self.assertLess(one, 2e-3)  # two steps of a list are a thousandth of its span

    def test_scrubbing_moves_the_points_and_the_structure(self):
        self.page.run("document.querySelector('#motions .panels').scrollIntoView()")
        self.page.frame()
        where = "[...document.querySelectorAll('#motions .panels circle')].map(c => c.getAttribute('cx') + c.getAttribute('cy')).join()"
        picture = "document.querySelector('canvas.structure').toDataURL()"
        self.slide("time", 100)
        before = self.value(where), self.value(picture)
        self.slide("time", 430)
        after = self.value(where), self.value(picture)
        self.assertNotEqual(before[0], after[0])
        self.assertNotEqual(before[1], after[1])

    def test_playing_goes_on_by_itself_until_paused(self):
        self.page.run("document.querySelector('#motions').scrollIntoView()")
        self.slide("time", 0)
        self.page.run("document.querySelector('#play').click()")
        self.page.wait("+document.querySelector('#time').value > 5")
        self.page.run("document.querySelector('#play').click()")
        self.page.frame()
        still = self.value("document.querySelector('#time').value")
        self.page.frame()
        self.assertEqual(self.value("document.querySelector('#time').value"), still)

    def test_hover_gives_numbers(self):
        self.page.place(".full-diagram svg > rect")
        point = self.value("""(() => { const one = [...charts].find(c => c.node.closest('.full-diagram'));
          const box = one.node.querySelector('svg').getBoundingClientRect(), [x, y] = one.pixel(0);
          return [box.x + x, box.y + y]; })()""")
        self.page.mouse("mouseMoved", point)
        self.page.frame()
        said = self.value("document.querySelector('.full-diagram .readout').textContent")
        self.assertRegex(said, r"belt speed V = 0\.\d+slip-state displacement x4 = -?\d")

    def test_zoom_pan_and_reset_by_keys_and_buttons(self):
        chart = "[...charts].find(c => c.node.closest('.full-diagram'))"
        self.page.run("document.querySelector('.full-diagram svg').focus()")
        whole = self.value(f"{chart}.view")
        self.page.key("+")
        closer = self.value(f"{chart}.view")
        self.assertAlmostEqual((whole["x"][1] - whole["x"][0]) / (closer["x"][1] - closer["x"][0]), 1.4, places=6)
        self.page.key("ArrowRight")
        self.assertGreater(self.value(f"{chart}.view")["x"][0], closer["x"][0])
        self.page.key("0")
        self.assertEqual(self.value(f"{chart}.view"), whole)
        self.page.click(".full-diagram .tools button:nth-child(1)")
        self.assertAlmostEqual(self.value(f"{chart}.view")["k"], 1.6)
        self.page.click(".full-diagram .tools button:nth-child(3)")
        self.assertEqual(self.value(f"{chart}.view"), whole)

    def test_dragging_pans(self):
        chart = "[...charts].find(c => c.node.closest('.full-diagram'))"
        self.page.click(".full-diagram .tools button:nth-child(1)")
        before = self.value(f"{chart}.view")
        point = self.page.place(".full-diagram svg > rect")
        self.page.mouse("mousePressed", point, button="left", clickCount=1)
        self.page.mouse("mouseMoved", (point[0] - 60, point[1]), button="left", buttons=1)
        self.page.mouse("mouseReleased", (point[0] - 60, point[1]), button="left", clickCount=1)
        self.page.frame()
        self.assertGreater(self.value(f"{chart}.view")["x"][0], before["x"][0])
        self.page.click(".full-diagram .tools button:nth-child(3)")

    def test_tables_sort_both_ways_and_copy_as_csv(self):
        # In headless Chromium no clipboard is allowed to a page of a file: what would be copied is caught.
        self.page.run("navigator.clipboard.writeText = async text => { window.copied = text; }")
        table = "[...document.querySelectorAll('details')].find(d => d.textContent.includes('(validation/shares)'))"
        column = f"[...{table}.querySelectorAll('tbody tr')].map(r => +r.children[1].textContent)"
        head = f"{table}.querySelectorAll('th')[1]"
        self.page.run(f"{head}.querySelector('button').click()")
        up = self.value(column)
        self.assertEqual(up, sorted(up))
        self.assertEqual(self.value(f"{head}.getAttribute('aria-sort')"), "ascending")
        self.page.run(f"{head}.querySelector('button').click()")
        self.assertEqual(self.value(column), sorted(up, reverse=True))
        self.page.run(f"{table}.querySelector('.bar button').click()")
        self.page.frame()
        lines = self.value("window.copied").split("\r\n")
        self.assertTrue(lines[0].startswith("basis,modes,energy [%],"))
        self.assertEqual(len(lines) - 2, len(up))
        self.assertEqual([float(line.split(",")[1]) for line in lines[1:-1]], sorted(up, reverse=True))

    def test_light_and_dark(self):
        ground = "getComputedStyle(document.body).backgroundColor"
        light = self.value(ground)
        self.page.click("#theme")
        self.assertNotEqual(self.value(ground), light)
        self.page.click("#theme")
        self.assertEqual(self.value(ground), light)

    def test_a_narrow_window_needs_no_sideways_scrolling(self):
        self.page.resize(380, 800)
        self.page.frame()
        self.assertLessEqual(self.value("document.documentElement.scrollWidth"), 380)
        self.page.resize(1280, 900)
        self.page.frame()


# Three masses, the last one held by a shaken slider with friction that sticks and slips.
SHAKEN = """
title = "shaken"
units = "dimensionless"
[structure]
kind = "chain"
masses = 3
damping = 0.1
[[contact]]
at = 3
law = "coulomb"
mu_s = 0.4
mu_k = 0.3
normal_load = 1.0
[drive]
kind = "shaker"
frequency = 0.1
amplitude = 1.0
[time]
cycles = 60
transient_cycles = 40
samples_per_cycle = 64
[ensemble]
members = 2
spread = 0.01
[reduction]
modes = 2
[validation]
cycles = 200
kept = 60
frequencies = { from = 0.05, to = 0.15, step = 0.05 }
modes = [1, 2, 3]
cost_cycles = 20
cost_repeats = 1
"""


# The same, pushed at the first mass.
PUSHED = SHAKEN.replace('kind = "shaker"\nfrequency = 0.1', 'kind = "force"\nat = 1\nomega = 0.7').replace(
    "frequencies = { from = 0.05, to = 0.15, step = 0.05 }", "omegas = { from = 0.4, to = 1.0, step = 0.3 }")


@unittest.skipUnless(chromium.executable(), "no Chromium here (Debian: chromium)")
class RunOnAShaker(unittest.TestCase):
    scene, least, most = SHAKEN, "0.05", "0.15"
    one = "validation.frequencies={ from = 0.1, to = 0.1, step = 0.1 }"

    def look(self, examine, *sets):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "scene.toml").write_text(self.scene)
            slipmode("run", "scene.toml", "-o", "out", *sets, folder=folder)
            with chromium.Page(pathlib.Path(folder) / "out" / "report.html") as page:
                page.run("document.querySelector('#play').click()")
                examine(page)
                self.assertEqual(page.complaints, [])

    def test_a_click_on_a_frequency_shows_its_motion_in_full_and_reduced(self):
        def examine(page):
            self.assertEqual(page.run("document.querySelector('#motions h2').textContent"), "Motions at a frequency")
            for share, frequency in ((0.04, self.least), (0.96, self.most)):  # of the diagram's width, margins of 4 %
                page.click(".full-diagram svg > rect", x=share)
                self.assertIn(f"= {frequency}", page.run("document.querySelector('#told').textContent"))
            page.run("document.querySelector('#motions .panels').scrollIntoView()")
            for modes in (1, 3):
                page.run(f"""(() => {{ const own = document.querySelector('#modes');
                  own.value = {modes - 1}; own.dispatchEvent(new Event('input')); }})()""")
                page.frame()
                for chart in page.run("[...document.querySelectorAll('#motions .panels svg')].map(s => s.textContent)"):
                    self.assertRegex(chart, f"{modes} (modes of |POMs|LNMs)")
            # All modes kept: the full motion in other coordinates; it repeats with the drive, so both are in phase.
            apart = page.run("""(async () => {
              const own = await documentOf(document.getElementById("motion-data")), last = own.models.length - 1;
              return own.speeds.map((frequency, k) => {
                const [a, b] = [0, last].map(m => list(own.models[m].motions[k].q));
                return [own.models[0].said[k], d3.max(a.map((value, i) => Math.abs(value - b[i]))) / (d3.max(a) - d3.min(a))];
              });
            })()""")
            compared = [distance for said, distance in apart if "period" in said]
            self.assertTrue(compared, apart)
            self.assertLess(max(compared), 2e-3)  # two steps of a list are a thousandth of its span

        self.look(examine)

    def test_at_one_frequency_there_is_no_choice_of_it(self):
        def examine(page):
            self.assertEqual(page.run("document.querySelector('#motions h2').textContent"),
                             "Motion, in full and reduced")
            self.assertTrue(page.run("document.querySelector('#speed').disabled"))
            self.assertIsNone(page.run("document.querySelector('.full-diagram')"))

        self.look(examine, "--set", self.one)


class RunUnderAForce(RunOnAShaker):
    scene, least, most = PUSHED, "0.4", "1"
    one = "validation.omegas={ from = 0.7, to = 0.7, step = 0.1 }"

    def test_a_model_that_could_not_be_made_is_not_trusted(self):
        # One mode cannot hold two contacts that stick rigidly.
        own = "[[contact]]" + self.scene.split("[[contact]]")[1].split("[drive]")[0]
        self.scene = self.scene.replace(own, own + own.replace("at = 3", "at = 2"))

        def examine(page):
            told = page.run("document.querySelector('.answers').textContent")
            self.assertIn("section points lie", told)
            self.assertNotRegex(told, r"\b1 mode |\binf\b|\bnan\b")

        self.look(examine, "--set", self.one)


@unittest.skipUnless(chromium.executable(), "no Chromium here (Debian: chromium)")
class FilesOfOtherKinds(unittest.TestCase):
    BACKLASH = str(pathlib.Path(__file__).parents[2] / "datasets" / "backlash_sdof" / "scene.toml")
    CHAIN = str(pathlib.Path(__file__).parents[2] / "datasets" / "chain10" / "scene.toml")

    def look(self, words, examine, name="made.h5"):
        with tempfile.TemporaryDirectory() as folder:
            slipmode(*words, "-o", name, folder=folder)
            slipmode("report", name, "-o", "page.html", folder=folder)
            with chromium.Page(pathlib.Path(folder) / "page.html") as page:
                examine(page)
                self.assertEqual(page.complaints, [])

    def moves(self, page, control):
        """A control's ends give different pictures."""
        page.run(f"document.querySelector('{control}').scrollIntoView({{block: 'center'}})")
        pictures = []
        for end in ("min", "max"):
            page.run(f"""(() => {{ const own = document.querySelector('{control}');
              own.value = own[{json.dumps(end)}]; own.dispatchEvent(new Event('input')); }})()""")
            page.frame()
            pictures.append(page.run("document.querySelector('canvas.structure').toDataURL()"))
        self.assertNotEqual(*pictures)

    def test_an_orbit_moves(self):
        def examine(page):
            self.assertIn("phase portrait of the orbit", page.run("document.body.textContent"))
            # Half a period apart: an orbit's ends are the same.
            page.run("document.querySelector('.scrub').max = 500")
            self.moves(page, ".scrub")
        self.look(("orbit", "find", self.CHAIN, "--set", "drive.speed=0.45"), examine)

    def test_natural_modes_move(self):
        self.look(("modes", self.CHAIN), lambda page: self.moves(page, ".mode"))

    def test_basins_are_coloured_and_told(self):
        def examine(page):
            page.place(".chart svg > rect")
            point = page.place(".chart svg > rect", 0.02, 0.02)
            page.mouse("mouseMoved", point)
            page.frame()
            said = page.run("document.querySelector('.chart .readout').textContent")
            # The corner of the plane of starts: displacement -3, velocity 3.
            self.assertRegex(said, r"displacement at the start, q1 = -3velocity at the start, v1 = 3$")
        self.look(("orbit", "basins", self.BACKLASH, "--over", "initial.displacement.0=-3:3:0.6", "--over",
                   "initial.velocity.0=-3:3:0.6"), examine)

    def test_a_branch_tells_stable_from_unstable(self):
        def examine(page):
            page.place(".chart svg")  # drawn when it is in sight
            page.wait("document.querySelector('.chart svg').textContent !== ''")
            legend = page.run("document.querySelector('.chart svg').textContent")
            for word in ("main branch", "unstable", "fold"):
                self.assertIn(word, legend)
        self.look(("orbit", "continue", self.BACKLASH, "--over", "drive.omega=1.8:1.0", "--start", "2.5,0"), examine)


class Refusals(unittest.TestCase):
    def test_a_folder_without_results_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            said = subprocess.run([EXECUTABLE, "report", ".", "-o", "r.html"], cwd=folder, capture_output=True, text=True)
            self.assertEqual(said.returncode, 2)
            self.assertIn("no result file", said.stderr)
            self.assertEqual(list(pathlib.Path(folder).iterdir()), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
