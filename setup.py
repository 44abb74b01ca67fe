"""For `pip install .`: the extension is built by CMake, as it is without pip, for the Python that asks.

CMAKE_ARGS adds options ("-DSLIPMODE_ARCH=native"), CMAKE_BUILD_PARALLEL_LEVEL limits the compilers that run at once.
"""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = pathlib.Path(__file__).parent.resolve()


def pybind11_option():
    """Where pip's own pybind11 is; without it CMake looks for the system's."""
    try:
        import pybind11
    except ImportError:
        return []
    return [f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"]


class ByCMake(build_ext):
    def build_extension(self, extension):
        build = pathlib.Path(self.build_temp).resolve()
        subprocess.run(
            ["cmake", "-S", SOURCE, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON",
             "-DCMAKE_UNITY_BUILD_BATCH_SIZE=12", "-DSLIPMODE_TESTS=OFF", "-DSLIPMODE_MPI=OFF", "-DSLIPMODE_PYTHON=ON",
             f"-DPython_EXECUTABLE={sys.executable}", *pybind11_option(),
             *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "slipmode_python_stub"], check=True)
        built, = (build / "python/slipmode").glob("_slipmode.*")
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(built, target)
        for typed in ("__init__.pyi", "py.typed"):
            shutil.copy(build / "python/slipmode" / typed, target.parent)


setup(
    version=re.search(r"project\(slipmode VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text())[1],
    ext_modules=[Extension("slipmode._slipmode", [])],
    cmdclass={"build_ext": ByCMake},
)
