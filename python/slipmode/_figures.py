"""Figures of results by matplotlib, with the content of those that the executable draws and the report shows."""

import base64
import html
import importlib.util
import io
import math
import re

import numpy as np

from . import _slipmode

_GREEK = str.maketrans("abgdelmnoprstwxzD", "αβγδελμνοπρστωξζΔ")
_SHARED = {"none": False, "all": True, "row": "row", "column": "col"}
_LOOKS = {
    "line": {"linewidth": 1.0},
    "dashed": {"linewidth": 1.0, "linestyle": "--"},
    "dots": {"linestyle": "none", "marker": ".", "markersize": 2.0, "markeredgewidth": 0.0},
    "marked": {"linewidth": 1.0, "marker": "o", "markersize": 4.0},
    "points": {"linestyle": "none", "marker": "o", "markersize": 5.0},
}


def _plain(text):
    """Text in which a dollar is a dollar."""
    return text.replace("$", r"\$")


def _label(text):
    """A label as gnuplot takes it, "x_{10} [m]", as matplotlib does."""
    text = re.sub(r"\{/Symbol (\w)\}", lambda found: found[1].translate(_GREEK), _plain(text))
    text = re.sub(r"(?<!\\)([_^])\{([^}]*)\}", r"$\1{\\mathregular{\2}}$", text)
    return re.sub(r"\\+([_^{}@&~])", r"\1", text)


def _draw_field(figure, axes, field):
    words, low, high = field["words"], field["low"], field["high"]
    colours = "viridis"
    if words:
        import matplotlib

        colours, low, high = matplotlib.colormaps["viridis"].resampled(len(words)), low - 0.5, high + 0.5
    mesh = axes.pcolormesh(field["x"], field["y"], np.ma.masked_invalid(field["value"]), shading="nearest", cmap=colours,
                           vmin=low, vmax=high, rasterized=True)
    bar = figure.colorbar(mesh, ax=axes, label=_label(field["label"]))
    if words:
        bar.set_ticks(np.linspace(low + 0.5, high - 0.5, len(words)), labels=words)


def draw(drawing):
    """A matplotlib figure of what `_slipmode.figures` tells of one."""
    from matplotlib.figure import Figure

    panels, columns = drawing["panels"], min(drawing["columns"], len(drawing["panels"]))
    rows = math.ceil(len(panels) / columns)
    figure = Figure(figsize=(9.0, 4.5 if rows == 1 else 2.7 * rows), layout="constrained")
    places = figure.subplots(rows, columns, squeeze=False, sharex=_SHARED[drawing["shared_x"]],
                             sharey=_SHARED[drawing["shared_y"]]).flat
    for axes in places[len(panels):]:
        axes.remove()
    one_x, one_y = (len({panel[label] for panel in panels}) == 1 for label in ("x_label", "y_label"))
    legends = set()
    for k, (axes, panel) in enumerate(zip(places, panels)):
        for begin, end in panel["shaded"]:
            axes.axvspan(begin, end, color=drawing["shade"], linewidth=0.0, zorder=0)
        if panel["field"] is not None:
            _draw_field(figure, axes, panel["field"])
        named = {}
        for series in panel["series"]:
            curve, = axes.plot(series["x"], series["y"], color=series["colour"] or None, **_LOOKS[series["look"]])
            if len(series["error"]) > 0:
                axes.errorbar(series["x"], series["y"], series["error"], fmt="none", ecolor=curve.get_color())
            if series["title"]:
                named.setdefault(series["title"], curve)
        axes.set_title(_plain(panel["title"]))
        if not one_x or k + columns >= len(panels):
            axes.set_xlabel(_label(panel["x_label"]))
        if not one_y or k % columns == 0:
            axes.set_ylabel(_label(panel["y_label"]))
        if panel["log_x"]:
            axes.set_xscale("log")
        if panel["log_y"]:
            axes.set_yscale("log")
        if named and tuple(named) not in legends:
            axes.legend(named.values(), [*map(_plain, named)], fontsize="small")
            legends.add(tuple(named))
    return figure


def as_html(store, most):
    """So many figures of a result as images in a page; nothing where there is no matplotlib."""
    if importlib.util.find_spec("matplotlib") is None:
        return ""
    text = ""
    for drawing in _slipmode.figures(store, most):
        picture = io.BytesIO()
        draw(drawing).savefig(picture, format="png", dpi=80)
        data = base64.b64encode(picture.getvalue()).decode()
        text += f'<p><img alt="{html.escape(drawing["what"])}" src="data:image/png;base64,{data}"></p>'
    return text
