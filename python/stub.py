"""Writes slipmode/__init__.pyi, what editors and type checkers are to know of the package, from what it says of itself:
python3 stub.py slipmode/__init__.pyi"""

import inspect
import pathlib
import re
import sys

sys.path.pop(0)  # this folder, whose package is not built
import slipmode  # noqa: E402

HEADER = '''# Made by python/stub.py of the package itself.
import os
from collections.abc import Callable
from typing import Any, List, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

__version__: str
'''
SHOWN = ("__getattr__", "__getitem__", "__contains__", "__add__")


def text_of(doc, indent):
    lines = re.sub(r'"(?=""|$)', r'\\"', inspect.cleandoc(doc or "").replace("\\", "\\\\")).split("\n")
    if not lines[0]:
        return f"{indent}...\n"
    body = f"\n{indent}".join(lines).replace(f"\n{indent}\n", "\n\n")
    return f'{indent}"""{body}{chr(10) + indent if len(lines) > 1 else ""}"""\n{indent}...\n'


def of_python(own):
    """Signature of a function of Python, without quotes about its annotations."""
    def bare(annotation):
        return slipmode._Type(annotation) if isinstance(annotation, str) else annotation

    said = inspect.signature(own)
    parameters = [one.replace(annotation=bare(one.annotation)) for one in said.parameters.values()]
    return str(said.replace(parameters=parameters, return_annotation=bare(said.return_annotation)))


def of_pybind(doc):
    """Signature and documentation of a function of C++: "name(self: ..., key: str) -> float", then what it is."""
    line, _, rest = doc.partition("\n")
    return re.sub(r"(self|arg0): [\w.]+", "self", line[line.index("("):].replace("slipmode._slipmode.", "")), rest


def function(name, own, indent="", said=None):
    own = getattr(own, "__func__", own)
    signature, doc = (of_python(own), own.__doc__) if inspect.isfunction(own) else of_pybind(own.__doc__)
    return f"{indent}def {name}{signature}:\n{text_of(said or doc, indent + '    ')}"


def member(name, own):
    if isinstance(own, property):
        return "    @property\n" + function(name, own.fget, "    ", own.__doc__)
    lead = "    @staticmethod\n" if isinstance(own, staticmethod) else ""
    return lead + function(name, own, "    ")


def class_of(own):
    bases = ", ".join(base.__name__ for base in own.__bases__ if base.__name__ not in ("object", "pybind11_object"))
    text = f"class {own.__name__}{f'({bases})' if bases else ''}:\n{text_of(own.__doc__, '    ')}"
    for name, value in vars(own).items():
        is_member = callable(value) or isinstance(value, (property, staticmethod))
        if name in SHOWN or (is_member and not name.startswith("_")):
            text += "\n" + member(name, value)
    if own is slipmode.NumericalFailure:
        text += "    time: float\n    state: np.ndarray\n    residual: float\n    result: Result | None\n"
    return text


own = [value for name, value in vars(slipmode).items() if not name.startswith("_") and not inspect.ismodule(value)]
classes = [value for value in own if inspect.isclass(value)]
classes.insert(classes.index(slipmode.Result), slipmode.Result.__bases__[0])
parts = list(map(class_of, classes))
parts += [function(value.__name__, value) for value in own if inspect.isfunction(value)]
pathlib.Path(sys.argv[1]).write_text(HEADER + "\n\n" + "\n\n".join(parts))
