"""Pictures of the stress suite as SVG files: lines and points in a frame, logarithmic or linear, the legend beside it.

bench_svg.py draws into HTML; a file of its own has to be well-formed XML.
"""

import html
import math

from bench_svg import decades

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 400, 64, 190, 12, 44
STYLE = ("text{font:12px sans-serif;fill:#222}.k{stroke:#ddd;fill:none}.l{fill:none;stroke-width:1.6}.d{stroke:none}"
         "rect{fill:#fff}")


class Logarithmic:
    def __init__(self, values, low, high):
        self.ends, (self.first, self.last) = (low, high), decades(values)

    def __call__(self, value):
        share = (math.log10(value) - self.first) / (self.last - self.first)
        return self.ends[0] + share * (self.ends[1] - self.ends[0])

    def ticks(self):
        apart = max(1, (self.last - self.first) // 8)
        return [(10.0 ** e, f"1e{e}") for e in range(self.first, self.last + 1, apart)]


class Linear:
    def __init__(self, values, low, high):
        self.ends, self.first, self.last = (low, high), math.floor(min(values)), math.ceil(max(values))

    def __call__(self, value):
        return self.ends[0] + (value - self.first) / (self.last - self.first) * (self.ends[1] - self.ends[0])

    def ticks(self):
        return [(value, str(value)) for value in range(self.first, self.last + 1)]


def axes(x, y, x_label, y_label):
    for value, text in x.ticks():
        yield (f'<path class="k" d="M{x(value):.0f} {TOP}V{HEIGHT - BOTTOM}"/>'
               f'<text x="{x(value):.0f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{text}</text>')
    for value, text in y.ticks():
        yield (f'<path class="k" d="M{LEFT} {y(value):.0f}H{WIDTH - RIGHT}"/>'
               f'<text x="{LEFT - 6}" y="{y(value) + 4:.0f}" text-anchor="end">{text}</text>')
    yield f'<text x="{(LEFT + WIDTH - RIGHT) / 2:.0f}" y="{HEIGHT - 8}" text-anchor="middle">{html.escape(x_label)}</text>'
    yield (f'<text transform="translate(14 {(TOP + HEIGHT - BOTTOM) / 2:.0f}) rotate(-90)" text-anchor="middle">'
           f'{html.escape(y_label)}</text>')


def series_of(one, x, y):
    places = [(x(a), y(b)) for a, b in one["points"]]
    if one.get("is_dots"):
        return "".join(f'<circle class="d" cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{one["colour"]}"/>' for a, b in places)
    dash = ' stroke-dasharray="5 3"' if one.get("is_dashed") else ""
    return f'<path class="l" stroke="{one["colour"]}"{dash} d="M' + "L".join(f"{a:.1f} {b:.1f}" for a, b in places) + '"/>'


def legend(series):
    for number, one in enumerate(one for one in series if one.get("name")):
        y = TOP + 12 + 18 * number
        dash = ' stroke-dasharray="5 3"' if one.get("is_dashed") else ""
        yield (f'<path class="l" stroke="{one["colour"]}"{dash} d="M{WIDTH - RIGHT + 12} {y - 4}h22"/>'
               f'<text x="{WIDTH - RIGHT + 40}" y="{y}">{html.escape(one["name"])}</text>')


def picture(series, x_label, y_label, is_linear=False):
    """series: name (or none: not in the legend), colour, points; is_dots, is_dashed. Text of an SVG file."""
    scale = Linear if is_linear else Logarithmic
    x = scale([point[0] for one in series for point in one["points"]], LEFT, WIDTH - RIGHT)
    y = scale([point[1] for one in series for point in one["points"]], HEIGHT - BOTTOM, TOP)
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}">',
                      f"<style>{STYLE}</style>", f'<rect width="{WIDTH}" height="{HEIGHT}"/>', *axes(x, y, x_label, y_label),
                      *(series_of(one, x, y) for one in series), *legend(series), "</svg>"]) + "\n"
