"""A diagram with two logarithmic axes as plain SVG: error over time, a line for each series, the legend beside it."""

import html
import math

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 1120, 540, 80, 230, 14, 48
ROW = 19        # of the legend


def decades(values):
    """From and to, as exponents, at least one apart."""
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    return low, max(high, low + 1)


def tick(exponent, is_time):
    if not is_time:
        return f"1e{exponent}"
    unit, at = next((unit, at) for unit, at in (("s", 9), ("ms", 6), ("µs", 3), ("ns", 0)) if exponent >= at or at == 0)
    return f"{10.0 ** (exponent - at):g} {unit}"


def axes(x, y, at):
    parts = []
    for exponent in range(x[0], x[1] + 1):
        px = at(10.0 ** exponent, 1)[0]
        parts.append(f"<path class=k d='M{px:.0f} {TOP}V{HEIGHT - BOTTOM}'/><text x={px:.0f} y={HEIGHT - BOTTOM + 17} text-anchor=middle>"
                     f"{tick(exponent, True)}</text>")
    for exponent in range(y[0], y[1] + 1):
        py = at(1, 10.0 ** exponent)[1]
        parts.append(f"<path class=k d='M{LEFT} {py:.0f}H{WIDTH - RIGHT}'/><text x={LEFT - 7} y={py + 4:.0f} text-anchor=end>"
                     f"{tick(exponent, False)}</text>")
    middle = (TOP + HEIGHT - BOTTOM) / 2
    parts.append(f"<text x={(LEFT + WIDTH - RIGHT) / 2:.0f} y={HEIGHT - 8} text-anchor=middle>time for one object over the whole span</text>"
                 f"<text transform='translate(18 {middle:.0f}) rotate(-90)' text-anchor=middle>error at the end, relative, median of the variants</text>")
    return parts


def group(one):
    return f"<g fill='{one['colour']}' stroke='{one['colour']}'" + (" stroke-dasharray='5 3'>" if one.get("is_dashed") else ">")


def line(one, at):
    places = [at(x, y) for x, y, _ in one["points"]]
    parts = [f"{group(one)}<path class=l d='M" + "L".join(f"{x:.0f} {y:.0f}" for x, y in places) + "'/>"]
    parts += [f"<circle cx={x:.0f} cy={y:.0f} r=3><title>{html.escape(text)}</title></circle>"
              for (x, y), (_, _, text) in zip(places, one["points"])]
    return "".join(parts) + "</g>"


def legend(series):
    for number, one in enumerate(series):
        y = TOP + 12 + ROW * number
        yield (f"{group(one)}<path class=l d='M{WIDTH - RIGHT + 16} {y - 4}h22'/>"
               f"<circle cx={WIDTH - RIGHT + 27} cy={y - 4} r=3 /></g><text x={WIDTH - RIGHT + 46} y={y}>{html.escape(one['name'])}</text>")


def figure(series):
    """series: name, colour, and points (nanoseconds, error, what the pointer says). A legend is outside of the axes."""
    series = [one for one in series if one["points"]]
    if not series:
        return "<p>No point.</p>"
    x = decades([point[0] for one in series for point in one["points"]])
    y = decades([point[1] for one in series for point in one["points"]])

    def at(time, error):
        return (LEFT + (math.log10(time) - x[0]) / (x[1] - x[0]) * (WIDTH - RIGHT - LEFT),
                TOP + (y[1] - math.log10(error)) / (y[1] - y[0]) * (HEIGHT - BOTTOM - TOP))
    return "\n".join([f"<svg viewBox='0 0 {WIDTH} {HEIGHT}' width={WIDTH} height={HEIGHT} role=img>", *axes(x, y, at),
                      *(line(one, at) for one in series), *legend(series), "</svg>"])
