#!/usr/bin/env python3
"""Curves as SVG by matplotlib, the same text whenever they are the same curves; the legend stands beside them.

    tools/plot.py FILE.svg ...      gives a picture that the command has drawn (--plot) the colours of dark pages, too
"""

import html
import io
import pathlib
import re
import sys

from fp3draw.svg import PALETTE

GRID, DARK_GRID = "#dddddd", "#30363d"


def rules():
    """What the reader of a dark page sees of white, black and the grid, as matplotlib and gnuplot write them."""
    page, ink = PALETTE["page"][2], PALETTE["ink"][2]
    yield page, ("fill", "stroke"), ("#ffffff",)
    yield ink, ("fill", "stroke", "color"), ("#000000", "black", "rgb(  0,   0,   0)")
    yield DARK_GRID, ("stroke",), (GRID, "rgb(221, 221, 221)")


def for_dark(text):
    """The picture, for light pages and for dark ones. Done twice it is the same."""
    said = [f"text{{fill:{PALETTE['ink'][2]}!important}}"]
    for colour, names, values in rules():
        for name in names:
            at = [f'[style*="{name}: {value}"],[{name}="{value}"]' for value in values if value in text]
            said += [f"{','.join(at)}{{{name}:{colour}!important}}"] if at else []
    sheet = f"<style>@media(prefers-color-scheme:dark){{{''.join(said)}}}</style>"
    return text if "@media" in text else re.sub(r"(<svg[^>]*>)", lambda found: f"{found[1]}\n{sheet}", text, count=1)


def figure(size):
    """An empty figure. matplotlib is imported here, because tools that only measure must run without it."""
    import matplotlib
    from matplotlib.figure import Figure
    matplotlib.rcParams.update({"svg.hashsalt": "fp3", "svg.fonttype": "none", "path.simplify": False, "font.family": "sans-serif",
                                "axes.grid": True, "grid.color": GRID, "lines.linewidth": 1.2, "lines.markersize": 4})
    return Figure(figsize=size)


def draw(series, x_label, y_label, size=(9, 5), is_map=False, unit=None):
    """series: name (none: not in the legend), look (colour, dash or none, mark or none), points; is_open: marks are rings. is_map: both
    axes are linear and alike, else logarithmic. unit: of x, where it goes from nanoseconds to seconds."""
    axes = figure(size).add_subplot()
    for number, one in enumerate(series):
        colour, dash, mark = one["look"]
        axes.plot(*zip(*one["points"]), color=colour, linestyle=dash or "none", marker=mark, label=one.get("name") or "_", gid=f"curve{number}",
                  markerfacecolor="white" if one.get("is_open") else colour)
    if is_map:
        axes.set_aspect("equal")
    else:
        axes.set(xscale="log", yscale="log")
    if unit:
        from matplotlib.ticker import EngFormatter
        axes.xaxis.set_major_formatter(EngFormatter(unit))
    axes.set(xlabel=x_label, ylabel=y_label)
    axes.minorticks_off()
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False, handlelength=4)
    text = io.StringIO()
    axes.figure.savefig(text, format="svg", bbox_inches="tight", metadata={"Date": None, "Creator": None})
    return for_dark(re.sub(r"'DejaVu Sans'[^;\"]*", "sans-serif", text.getvalue()))


def inline(series, *labels, **options):
    """The same for a page in HTML, with what the pointer says of each point (notes), and small: a page has thousands of points."""
    series = [one for one in series if one["points"]]
    if not series:
        return "<p>No point.</p>"
    text = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<clipPath.*?</clipPath>| clip-path=\"[^\"]*\"| xmlns\S*=\"[^\"]*\"|xlink:", "",
                  draw(series, *labels, **options).partition("<svg")[2], flags=re.S)
    text = re.sub(r"\n([LCz])", r"\1", re.sub(r"-?\d+\.\d\d+", lambda number: f"{float(number[0]):.1f}", text))
    for number, one in enumerate(series):
        head, _, rest = text.partition(f'<g id="curve{number}">')
        curve, end, rest = rest.partition("</g>\n   </g>")
        notes, colour = iter(one["notes"]), one["look"][0]
        curve = curve.replace("<g>", f'<g style="fill: {"white" if one.get("is_open") else colour}; stroke: {colour}">', 1)
        curve = re.sub(r'<use href="(\S+)" x="(\S+)" y="(\S+)"[^>]*/>',
                       lambda use: f"<use href={use[1]} x={use[2]} y={use[3]}><title>{html.escape(next(notes))}</title></use>", curve)
        text = f"{head}<g>{curve}{end}{rest}"
    return "<svg" + re.sub(r"\n\s*", "\n", text)


def main():
    for path in map(pathlib.Path, sys.argv[1:]):
        path.write_text(for_dark(path.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
