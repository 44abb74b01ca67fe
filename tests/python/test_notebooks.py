"""The notebooks run from their first cell to their last and draw what they say."""

import os
import pathlib
import unittest

FOLDER = pathlib.Path(os.environ["SLIPMODE_SOURCE_DIR"])

try:
    import matplotlib  # noqa: F401
    import nbclient
    import nbformat
    from jupyter_client.kernelspec import find_kernel_specs

    MISSING = "" if "python3" in find_kernel_specs() else "python3-ipykernel"
except ImportError as missing:
    MISSING = str(missing)


@unittest.skipIf(MISSING, f"needs python3-nbclient, python3-ipykernel and python3-matplotlib: {MISSING}")
class Notebooks(unittest.TestCase):
    def test_run_and_draw(self):
        os.environ["SLIPMODE_DATASETS"] = str(FOLDER / "datasets")
        books = sorted((FOLDER / "python/notebooks").glob("*.ipynb"))
        self.assertGreaterEqual(len(books), 4)
        for path in books:
            with self.subTest(path.stem):
                book = nbformat.read(path, as_version=4)
                self.assertFalse(any(cell.get("outputs") for cell in book.cells), "keep notebooks without their outputs")
                nbclient.NotebookClient(book, timeout=300, kernel_name="python3").execute()
                outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
                figures = [output for output in outputs if "image/png" in output.get("data", {})]
                self.assertGreaterEqual(len(figures), 2 if path.stem != "matrices" else 1)
                warnings = [o.text for o in outputs if o.output_type == "stream" and "Warning" in o.text]
                self.assertEqual(warnings, [])


if __name__ == "__main__":
    unittest.main()
