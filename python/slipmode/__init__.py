"""Reduced-order modelling of friction-excited structures.

    import slipmode as sm
    scene = sm.Scene.load("scene.toml", set={"drive.speed": 0.25})
    run = sm.simulate(scene)              # run.t, run.q, run.events, run.audit; run.plot(), run.figures()
    rom = sm.reduce(scene, sm.pod(run), modes=6)

A scene may be given as a Scene, as a file's path, or as a dict of the tables of a scene file. Every study gives a Result,
which has what its file would have, under the same names; `result.save(path)` writes that file, `sm.read(path)` reads it.
Errors are InvalidInput (a ValueError) and NumericalFailure (a RuntimeError); Ctrl-C ends a study.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import html
import inspect
import os
import re
import reprlib
import sys
import warnings

import numpy as np

from . import _figures, _slipmode
from ._slipmode import InvalidInput, NumericalFailure, Scene, __version__

# ---------------------------------------------------------------- scenes


def _toml(value):
    """A value as TOML; NumPy's arrays and SciPy's sparse matrices as arrays."""
    if hasattr(value, "toarray"):
        value = value.toarray()
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        escaped = {'"': '\\"', "\\": "\\\\"}
        return '"' + "".join(escaped.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in value) + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_toml(str(key))} = {_toml(item)}" for key, item in value.items()) + " }"
    raise InvalidInput(f"scene: {value!r}: expected a number, text, list, array or dict")


def _document(tables):
    """A dict as a scene file: a line per key, each table under its heading."""
    plain = {key: value for key, value in tables.items() if not isinstance(value, dict)}
    lines = [f"{_toml(str(key))} = {_toml(value)}" for key, value in plain.items()]
    for name, table in tables.items():
        if isinstance(table, dict):
            lines += ["", f"[{_toml(str(name))}]"]
            lines += [f"{_toml(str(key))} = {_toml(value)}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def _load(source: Scene | str | os.PathLike | dict, set: dict | None = None) -> Scene:
    """A scene from a file's path, a dict of its tables (arrays of tables as lists of dicts), or another scene.

    set: keys to change, for example {"drive.speed": 0.25, "contact.0.mu_s": 0.5}
    """
    changes = [f"{key}={_toml(value)}" for key, value in (set or {}).items()]
    if isinstance(source, Scene):
        if not changes:
            return source
        return _slipmode.parse_scene(source.text, source.overrides + changes, source.path)
    if isinstance(source, dict):
        return _slipmode.parse_scene(_document(source), changes, "<dict>")
    if isinstance(source, (str, os.PathLike)):
        return _slipmode.load_scene(os.fspath(source), changes)
    raise InvalidInput(f"scene: {type(source).__name__}: expected a Scene, the path of a scene file, or a dict")


Scene.load = staticmethod(_load)


def _set(self, changes: dict | None = None, /, **named: object) -> Scene:
    """The same scene with keys changed: scene.set({"drive.speed": 0.25}), or scene.set(drive__speed=0.25)."""
    return _load(self, dict(changes or {}) | {key.replace("__", "."): value for key, value in named.items()})


Scene.set = _set


class Tables(dict):
    """Tables of a scene; `+` joins them: structure(M, C, K) + contact(...) + {"drive": {...}, "time": {...}}."""

    def __add__(self, other: dict) -> Tables:
        joined = Tables(self)
        for name, table in other.items():
            joined[name] = joined[name] + table if name == "contact" and name in joined else table
        return joined

    def __radd__(self, other):
        return Tables(other) + self


def structure(M: npt.ArrayLike, C: npt.ArrayLike, K: npt.ArrayLike) -> Tables:
    """A structure of matrices, n x n, NumPy's or SciPy's sparse ones."""
    return Tables(structure={"kind": "matrices", "mass": M, "damping": C, "stiffness": K})


def contact(at: int | list[int], law: str, **numbers: object) -> Tables:
    """A contact: `at` the number of a degree of freedom from 1 (or a pair of them), its law's word and its numbers, as in
    [[contact]] of a scene file."""
    return Tables(contact=[{"at": at, "law": law, **numbers}])


# ---------------------------------------------------------------- results


def _aligned(rows):
    """Rows of texts, column below column."""
    width = [max(map(len, column)) for column in zip(*rows)]
    return "\n".join("  ".join(map(str.ljust, row, width)).rstrip() for row in rows)


def _html_table(header, rows):
    lines = ("".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in rows)
    return "<table><tr>" + "".join(f"<th>{name}</th>" for name in header) + "</tr>" + "".join(
        f"<tr>{line}</tr>" for line in lines) + "</table>"


def _is_complex(value, description):
    return isinstance(value, np.ndarray) and value.shape[-1:] == (2,) and description.endswith("(real, imaginary)")


class _Branch:
    """A group of a result: its datasets and groups are attributes; tables, and events, are structured arrays."""

    def __init__(self, store, prefix):
        self._store = store
        self._prefix = prefix

    def _value(self, name):
        value = self._store.value(name)
        if _is_complex(value, self._store.meaning(name)[1]):
            return value.view(complex)[..., 0]
        return value

    @functools.cached_property
    def _names(self):
        start = len(self._prefix)
        return [name[start:] for name in self._store.names() if name.startswith(self._prefix)]

    @functools.cached_property
    def _children(self):
        return list(dict.fromkeys(name.split("/", 1)[0] for name in self._names))

    def _child(self, name):
        if name in self._names:
            return self._value(self._prefix + name)
        group = _Branch(self._store, f"{self._prefix}{name}/")
        return group if group._columns is None else group._table()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # also what __init__ has not set yet, which the message below needs
            raise AttributeError(name)
        if name in self._children:
            return self._child(name)
        raise AttributeError(f"no {name!r} here; there are: {', '.join(self._children)}")

    def __getitem__(self, name: str) -> Any:
        """By its name in the file, for example result["trajectory/q"]."""
        if name in self._names or any(other.startswith(f"{name}/") for other in self._names):
            return self._child(name)
        raise KeyError(name)

    def __contains__(self, name: str) -> bool:
        return name in self._names or name in self._children

    def __dir__(self):
        return [*super().__dir__(), *self._children]

    @property
    def _columns(self):
        """Names of a table's columns, in order; None of what is no table."""
        if "columns" in self._names:
            return self._value(f"{self._prefix}columns")
        return self._names if self._prefix.endswith("events/") else None

    def _table(self):
        columns = {name: np.asarray(self._value(self._prefix + name)) for name in self._columns}
        table = np.empty(len(next(iter(columns.values()))), [(name, column.dtype) for name, column in columns.items()])
        for name, column in columns.items():
            table[name] = column
        return table

    def unit(self, name: str) -> str:
        """Unit of a dataset: "1" of a pure number, "" of what has none."""
        return self._store.meaning(self._prefix + name)[0]

    def meaning(self, name: str) -> str:
        """What a dataset or group is."""
        return self._store.meaning(self._prefix + name)[1]

    def _rows(self):
        """name, value or shape, unit, meaning of each dataset."""
        for name in self._names:
            value = self._value(self._prefix + name)
            if isinstance(value, np.ndarray):
                said = " x ".join(map(str, value.shape))
            elif isinstance(value, list):
                said = ", ".join(value) if len(value) < 4 else f"{len(value)} texts"
            else:
                said = f"{value:.6g}" if isinstance(value, float) else str(value)
            said = said.splitlines()[0] + " ..." if "\n" in said else said
            unit, meaning = self._store.meaning(self._prefix + name)
            yield name, said if len(said) <= 40 else said[:37] + "...", unit, meaning

    def _shown(self):
        """The rows, of groups that hold the same only the first ones: a comparison has one for each reduced model."""
        members = {}
        for name in self._names:
            for at in (k for k, letter in enumerate(name) if letter == "/"):
                members.setdefault(name[:at], []).append(name[at:])
        alike = {}
        for group, held in members.items():
            alike.setdefault((group.rpartition("/")[0], *held), []).append(group)
        folded = {group: groups for groups in alike.values() if len(groups) > 3 for group in groups[1:]}
        for row in self._rows():
            above = [row[0][:at] for at, letter in enumerate(row[0]) if letter == "/"]
            first = next((group for group in above if group in folded), None)
            if first is None:
                yield row
            elif first == folded[first][1] and row[0] == first + members[first][0]:
                yield f"{first}, ...", f"{len(folded[first]) - 1} groups", "", f"as {folded[first][0]}"

    def __repr__(self):
        return _aligned(list(self._shown()))

    def _repr_html_(self):
        return _html_table(("name", "value", "unit", "meaning"), self._shown())


_MOST_FIGURES = 3  # in a notebook, below the table


class Result(_Branch):
    """What a study gives, or a result file holds: datasets under the names of the file.

    result["trajectory/q"] is one of them by its name; as an attribute, result.q, it is looked for in the outermost group that
    has it. Arrays are views, not copies, and not to be written to. print(result) says what there is.
    """

    def __init__(self, store):
        super().__init__(store, "")

    @property
    def kind(self) -> str:
        """What it is: "trajectory", "pod", "branches", ..."""
        return self._store.kind

    @property
    def scene(self) -> Scene:
        """The scene it was made from."""
        return self._store.scene()

    def save(self, path: str | os.PathLike) -> None:
        """Writes the file the executable would have written. Appears whole or not at all."""
        self._store.save(os.fspath(path))

    @functools.cached_property
    def _places(self):
        """Where an attribute is: in the file itself, or in the outermost group that has it; provenance comes last. Columns
        stay in their tables."""
        places = {}
        for last in (False, True):
            branches = [self]
            while branches:
                inner = []
                for branch in branches:
                    for child in branch._children:
                        if branch is self and last != (child == "provenance"):
                            continue
                        places.setdefault(child, branch._prefix)
                        group = _Branch(self._store, f"{branch._prefix}{child}/")
                        if group._names and group._columns is None:
                            inner.append(group)
                branches = inner
        return places

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._places:
            return _Branch(self._store, self._places[name])._child(name)
        raise AttributeError(f"a {self.kind} has no {name!r}; there are: {', '.join(self._places)}")

    def __dir__(self):
        return [*super().__dir__(), *self._places]

    def _rows(self):
        return (row for row in super()._rows() if not row[0].startswith("provenance/"))

    def __repr__(self):
        return f"<slipmode {self.kind}>\n{super().__repr__()}"

    def figures(self) -> dict[str, Any]:
        """What it shows, as matplotlib's figures by their names, the most telling first: those that the executable draws
        of its file. result.figures()["bifurcation"].savefig("bifurcation.pdf")
        """
        return {drawing["name"]: _figures.draw(drawing) for drawing in _slipmode.figures(self._store)}

    def _repr_html_(self):
        return super()._repr_html_() + self._figures_html()

    def _figures_html(self):
        return _figures.as_html(self._store, _MOST_FIGURES)

    def to_xarray(self) -> Any:
        """All arrays as an xarray.Dataset (needs xarray) with their units and meanings. Dimensions are named as meanings
        name them ("time x dof"), columns of a table by their group, others by number."""
        import xarray

        variables = {}
        for name in self._names:
            value = self._value(name)
            if not isinstance(value, (np.ndarray, list)) or name.startswith("provenance/"):
                continue
            value = np.asarray(value)
            unit, meaning = self._store.meaning(name)
            group, _, last = name.rpartition("/")
            rows, _, columns = meaning.rpartition(",")[2].partition(" x ")
            if value.ndim == 2 and columns and 0 not in value.shape:
                dims = [f"{group}/{rows.split()[-1]}", f"{group}/{columns.split()[0]}"]
            elif _Branch(self._store, f"{group}/")._columns is not None and last != "columns":
                dims = [group]
            else:
                dims = [f"{name}_{k}" for k in range(value.ndim)]
            variables[name] = (dims, value, {"units": unit, "description": meaning})
        for name in {dim for dims, *_ in variables.values() for dim in dims} & variables.keys():
            variables[name] = ([name], *variables[name][1:])  # instants of what goes over them
        return xarray.Dataset(variables, attrs={"kind": self.kind})

    def plot(self, x: str | None = None, y: str | None = None, axes: Any = None, **style: object) -> Any:
        """One dataset over another (needs matplotlib); gives the axes back. By default what the result is about."""
        import matplotlib.pyplot as plt

        x, y = _PLOTTED.get(self.kind, (x, y)) if x is None and y is None else (x, y)
        if x is None or y is None:
            raise InvalidInput(f"plot: of a {self.kind} say what: plot(x, y), two of its names")
        axes = axes or plt.gca()
        axes.plot(getattr(self, x) if "/" not in x else self[x], getattr(self, y) if "/" not in y else self[y], **style)
        for say, name in ((axes.set_xlabel, x), (axes.set_ylabel, y)):
            path = name if "/" in name else self._places[name] + name
            unit = self.unit(path)
            say(f"{name.rpartition('/')[2]} [{unit}]" if unit not in ("", "1") else name.rpartition("/")[2])
        return axes


_PLOTTED = {"trajectory": ("time", "q"), "orbit": ("q", "v"), "pod": ("singular_values", "shares")}


class Run(Result):
    """A run: samples as time x quantity in t, q, v, contact_q, contact_v, lambda_, events as a structured array, audit,
    statistics, final_state."""

    @property
    def t(self) -> np.ndarray:
        """Sampling instants [s]."""
        return self.time

    @property
    def lambda_(self) -> np.ndarray:
        """Contact forces, time x contact [N]."""
        return self["trajectory/lambda"]

    def __dir__(self):
        return [*super().__dir__(), "t", "lambda_"]


class Trade(Result):
    """Speed against accuracy: rows is a structured array with a row for each configuration, the reference first; of a scene
    under a force orbits is one too, of ways to its periodic orbit. Printed they are tables."""

    _table_name = "trade/candidates"
    _shown = ("name", "dX", "dE", "points", "spread", "energy", "stick", "time", "failure")

    @property
    def rows(self) -> np.ndarray:
        """A row each."""
        return self[self._table_name]

    @property
    def sentences(self) -> str:
        """What follows, a line each."""
        said = list(self["trade/recommendations"])
        return "\n".join([*said, self["trade/choice/sentence"]] if "trade/choice/sentence" in self else said)

    @property
    def chosen(self) -> Scene:
        """The scene of the configuration that error or budget picked."""
        if "trade/choice/scene" not in self:
            raise InvalidInput("trade: nothing was to be chosen; give error or budget")
        if not self["trade/choice/scene"]:
            raise InvalidInput(self["trade/choice/sentence"])
        return _slipmode.parse_scene(self["trade/choice/scene"], [], "<chosen>")

    @property
    def _tables(self):
        """Names of the tables that are printed, and of their columns."""
        yield self._table_name, self._shown
        if "trade/orbits/name" in self:
            yield "trade/orbits", ("name", "error", "time", "other", "failure")

    def _cells(self, table, shown):
        """Header, then the rows, as texts."""
        rows = self[table]
        columns = []
        for name in shown:
            unit = self.unit(f"{table}/{name}")
            said = [("-" if np.isnan(value) else f"{value:.3g}") if isinstance(value, float) else str(value)
                    for value in rows[name].tolist()]
            columns.append([f"{name} [{unit}]" if unit not in ("", "1") else name, *said])
        return list(zip(*columns))

    def __repr__(self):
        tables = [_aligned(self._cells(*table)) for table in self._tables]
        return "\n".join([f"<slipmode {self.kind}>", self.sentences, *tables])

    def _repr_html_(self):
        said = html.escape(self.sentences).replace("\n", "<br>")
        tables = (self._cells(*table) for table in self._tables)
        return f"<p>{said}</p>" + "".join(_html_table(header, rows) for header, *rows in tables) + self._figures_html()


class Advice(Trade):
    """What a scene requires: rows is a structured array with the verdict of each effect; printed it is a table."""

    _table_name = "advice/effects"
    _shown = ("effect", "verdict", "measure", "error", "noise")

    @property
    def sentences(self) -> str:
        return self["advice/sentences"].rstrip()

    @property
    def lean(self) -> Scene:
        """The scene with only what it requires."""
        return _slipmode.parse_scene(self["advice/scene"], [], "<lean>")


def _kind_of(store):
    if store.kind == "trade":
        names = store.names()
        if "advice/sentences" in names:
            return Advice
        return Trade if "trade/recommendations" in names else Result
    return Run if store.kind in ("trajectory", "orbit") else Result


def read(path: str | os.PathLike) -> Result:
    """A result file, all of it in memory. Kinds, names and units are those the file gives itself."""
    store = _slipmode.read(os.fspath(path))
    return _kind_of(store)(store)


# ---------------------------------------------------------------- studies


@functools.cache
def _tqdm():
    """tqdm where it is installed and somebody looks, else None."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a notebook without widgets gets a bar of text
            from tqdm.auto import tqdm
    except ImportError:
        return None
    return tqdm if sys.stderr.isatty() or "ipykernel" in sys.modules else None


class _Bars:
    """Progress as a bar per part, and one more where a part begins anew; those left open are closed on leaving."""

    def __init__(self, tqdm):
        self._tqdm = tqdm
        self._open = {}

    def __call__(self, part, done, total):
        bar = self._open.get(part)
        if bar is not None and (bar.total != total or done < bar.n):
            self._open.pop(part).close()
            bar = None
        if bar is None:
            bar = self._open[part] = self._tqdm(total=total, desc=part)
        bar.update(done - bar.n)
        if done == total:
            self._open.pop(part).close()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        for bar in self._open.values():
            bar.close()


def _native(value):
    """What a study takes: stores for results, files read."""
    if isinstance(value, Result):
        return value._store
    if isinstance(value, (str, os.PathLike)) and os.fspath(value).endswith(".h5"):
        return _slipmode.read(os.fspath(value))
    return value


def _store(name, value, expected):
    """The store of an argument that has to be a result or its file."""
    native = _native(value)
    if not isinstance(native, _slipmode.Store):
        raise InvalidInput(f"{name}: {value!r}: expected {expected}")
    return native


def _native_record(value):
    """A result's store, a path as text, samples as they are."""
    if isinstance(value, Result):
        return value._store
    return os.fspath(value) if isinstance(value, os.PathLike) else value


def _asked(study, *arguments, **options):
    """study(...); arguments it does not take are refused in a line that says which it does."""
    try:
        return study(*arguments, **options)
    except TypeError as error:
        taken = re.search(r"incompatible function arguments.*\n +1\. (\(.*\)) -> ", str(error))
        if taken is None:
            raise
        given = [*map(reprlib.repr, arguments), *(f"{key}={reprlib.repr(value)}" for key, value in options.items())]
        taken = taken[1].replace("slipmode._slipmode.", "").replace("Store", "Result").replace("**kwargs", "**options")
        raise InvalidInput(f"{study.__name__}({', '.join(given)}): expected {study.__name__}{taken}") from None


class _Type(str):
    """An annotation, shown as it is written."""

    __repr__ = str.__str__


_PYBIND = {  # what pybind11 calls a type, and what is taken for it
    "slipmode._slipmode.Scene": "Scene | str | os.PathLike | dict",
    "slipmode._slipmode.Store": "Result | str | os.PathLike",
    "List[float]": "npt.ArrayLike",
    "numpy.ndarray[numpy.float64[m, n]]": "npt.ArrayLike",
}
_OPTION = re.compile(r"^    ([*]?)(\w+) \((.+?)\): (.*(?:\n {8}.*)*)", re.MULTILINE)


def _signature(doc, returns):
    """A call's signature: its arguments from pybind11's line of the documentation, its options from those that name a
    type, "name (type): meaning (default x)"."""
    line, text = doc.split("\n", 1)
    own = ast.parse(f"def {line}: ...").body[0].args
    parameter = inspect.Parameter
    defaults = [parameter.empty] * (len(own.args) - len(own.defaults)) + list(map(ast.literal_eval, own.defaults))
    parameters = []
    for argument, default in zip(own.args, defaults):
        words = ast.unparse(argument.annotation)
        for theirs, ours in _PYBIND.items():
            words = words.replace(theirs, ours)
        parameters.append(parameter(argument.arg, parameter.POSITIONAL_OR_KEYWORD, default=default, annotation=_Type(words)))
    for star, name, words, said in _OPTION.findall(text):
        if star:
            parameters.append(parameter(name, parameter.VAR_POSITIONAL, annotation=_Type(words)))
            continue
        default = re.search(r"\(default (.*)\)$", said)
        parameters.append(parameter(name, parameter.KEYWORD_ONLY, default=ast.literal_eval(default[1]) if default else None,
                                    annotation=_Type(words if default else f"{words} | None")))
    return inspect.Signature(parameters, return_annotation=_Type(returns))


def _named(function, name, returns, **taken):
    """@param taken: options that are also taken by their place, with their types"""
    function.__name__ = function.__qualname__ = name
    doc = getattr(_slipmode, name).__doc__
    function.__doc__ = doc.split("\n", 1)[1].strip()
    signature = _signature(doc, returns)
    own = [one.replace(kind=one.POSITIONAL_OR_KEYWORD, annotation=_Type(taken[one.name])) if one.name in taken else one
           for one in signature.parameters.values()]
    function.__signature__ = signature.replace(parameters=sorted(own, key=lambda one: one.kind))
    return function


def _study(name, kind=Result, subject=None):
    """A study of a scene, or of what `subject` makes of its first argument, as a function of Python."""
    study = getattr(_slipmode, name)

    def call(scene, *arguments, **options):
        progress = options.pop("progress", None)
        bars = _Bars(_tqdm()) if progress is None and _tqdm() is not None else contextlib.nullcontext()
        if progress:
            options["progress"] = progress
        elif isinstance(bars, _Bars):
            options["progress"] = bars
        for key in options.keys() & {"model", "basis"}:
            options[key] = _native(options[key])
        if options.get("output") is not None:
            options["output"] = os.fspath(options["output"])
        try:
            with bars:
                return kind(_asked(study, (subject or _load)(scene), *map(_native, arguments), **options))
        except NumericalFailure as failure:
            if failure.result is not None:
                failure.result = kind(failure.result)
            raise

    return _named(call, name, "list[str]" if kind is list else kind.__name__)


simulate = _study("simulate", Run)
ensemble = _study("ensemble")
validate = _study("validate")
find_orbit = _study("find_orbit", Run)
continue_orbit = _study("continue_orbit")
skeleton = _study("skeleton")
sweep = _study("sweep")
orbit_map = _study("orbit_map")
basins = _study("basins")
exponents = _study("exponents")
exponent_sweep = _study("exponent_sweep")
_trade = _study("trade", Trade)
advise = _study("advise", Advice)
run = _study("run", list)


def values(start, stop, step):
    return _asked(_slipmode.values, start, stop, step)


def modes(scene, count=0):
    return Result(_asked(_slipmode.modes, _load(scene), count))


def pod(motion, modes=0):
    return Result(_asked(_slipmode.pod, _store("motion", motion, "a result of simulate or ensemble, or its file"), modes))


def reduce(scene, basis, modes=0):
    if hasattr(basis, "__array__") or isinstance(basis, (list, tuple)):
        basis = np.asarray(basis, dtype=float)
        if basis.ndim != 2:
            raise InvalidInput(f"basis: array of {basis.ndim} dimensions: expected two, dof x mode")
    elif not isinstance(basis, str) or basis.endswith(".h5"):
        basis = _store("basis", basis, 'a result of pod or reduce, the word "lnm", or an array, dof x mode')
    return Result(_asked(_slipmode.reduce, _load(scene), basis, modes))


def spectrum(orbit, dofs=(), **options):
    if "model" in options:
        options["model"] = _native(options["model"])
    return Result(_asked(_slipmode.spectrum, _native(orbit), list(dofs), **options))


_diagnose = _study("diagnose", subject=_native_record)


def diagnose(record, **options):
    return _diagnose(record, **options)


def trade(scene, axes=None, **options):
    return _trade(scene, axes=",".join(axes) if isinstance(axes, (list, tuple)) else axes, **options)


_named(values, "values", "list[float]")
_named(trade, "trade", "Trade", axes="str | list[str] | None")
for _function in (modes, pod, reduce, spectrum, diagnose):
    _named(_function, _function.__name__, "Result")
