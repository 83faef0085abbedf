"""Pictures of the gallery: PNGs, 960 pixels wide, the same bytes in each run of one matplotlib.

Motion is recorded by fp3 run. Balls are drawn by fp3 view. All have the ground of fp3 view's pictures, so that they can be read on
light pages and on dark ones.
"""

import subprocess

from fp3gallery import errors
from fp3gallery import recorded
import matplotlib.image
import numpy as np
import PIL.Image
from fp3world import scene as ws
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from picture import COLOURS

WIDTH, HEIGHT, DPI = 960, 540, 120
LORENZ = 23.5, 25, 26.5, 30               # times at which the ensemble is seen
FRAMES, SMALLER = 48, 0.75                # of a film
GROUND, INK, FAINT = "#eef0f4", "#22252b", "#9aa0aa"
matplotlib.rcParams.update({"font.family": "DejaVu Sans", "font.size": 8, "text.color": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK,
                            "axes.edgecolor": FAINT, "axes.facecolor": GROUND, "axes.spines.top": False, "axes.spines.right": False})


def canvas(height=HEIGHT, **keys):
    figure = Figure(figsize=(WIDTH / DPI, height / DPI), dpi=DPI, facecolor=GROUND, layout="constrained")
    return figure, figure.subplots(**keys)


def bare(axes, x, y):
    """Equal scales and no axes; x, y: what is seen."""
    axes.set(aspect="equal", xlim=x, ylim=y)
    axes.set_axis_off()


def record(fp3, folder, scene, *options):
    return ws.record(fp3, ws.put(folder, scene.text(folder), scene.name), *options)


def trails(axes, x, y, colours, width=1.5, power=2.0):
    """A line for each column of [time, object], fainter the older it is."""
    for a, b, colour in zip(x.T, y.T, colours):
        points = np.stack([a, b], -1)
        shade = np.tile(matplotlib.colors.to_rgba(colour), (len(points) - 1, 1))
        shade[:, 3] = np.linspace(0, 1, len(shade)) ** power
        axes.add_collection(LineCollection(np.stack([points[:-1], points[1:]], 1), colors=shade, linewidths=width, capstyle="butt"))


def colours_of(name, count, first=0.0, last=0.92):
    return matplotlib.colormaps[name](np.linspace(first, last, count))


# ---- objects that see each other ----

def finer(grid, times):
    """A grid of vectors with so many more rows and columns, linear between them."""
    for axis in (0, 1):
        grid = np.moveaxis(grid, axis, 0)
        at = np.linspace(0, len(grid) - 1, (len(grid) - 1) * times + 1)
        low = np.minimum(at.astype(int), len(grid) - 2)
        share = (at - low)[:, None, None]
        grid = np.moveaxis((1 - share) * grid[low] + share * grid[low + 1], 0, axis)
    return grid


def flag(fp3, folder, scene):
    """Cloth with three stripes, the nearest last. The shade is how it faces the light: normals are between those of the masses."""
    found, _ = record(fp3, folder, scene, "--every", 64, "--steps", 2816)
    x = ws.vectors(found, "x")[-1].reshape(32, 20, 3)
    turn, lift = np.radians(24), np.radians(14)
    right = np.array([np.cos(turn), 0, np.sin(turn)])
    away = np.array([np.sin(turn) * np.cos(lift), -np.sin(lift), -np.cos(turn) * np.cos(lift)])
    up = np.cross(right, away)
    normal = finer(np.cross(np.gradient(x, axis=0), np.gradient(x, axis=1)), 6)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    fine = finer(x, 6)
    corners = np.stack([fine[:-1, :-1], fine[1:, :-1], fine[1:, 1:], fine[:-1, 1:]], 2).reshape(-1, 4, 3)
    light = np.array([0.86, 0.25, 0.44])
    shade = np.clip(0.2 + 0.95 * abs(normal[:-1, :-1] @ light), 0, 1.15)
    stripes = np.array([matplotlib.colors.to_rgb(colour) for colour in ("#e4572e", "#fff4dc", "#1f6fb2")])
    paint = np.clip(stripes[np.arange(shade.shape[1]) * 3 // shade.shape[1]] * shade[..., None], 0, 1).reshape(-1, 3)
    order = np.argsort(-(corners.mean(1) @ away))
    figure, axes = canvas(400)
    flat = np.stack([corners @ right, corners @ up], -1)
    axes.add_collection(PolyCollection(flat[order], facecolors=paint[order], edgecolors=paint[order], linewidths=0.4))
    pole = np.array([[0, -0.1, 0], [0, 1.0, 0]])
    axes.plot(pole @ right, pole @ up, color=INK, linewidth=4, solid_capstyle="round", zorder=0)
    bare(axes, (-0.35, 1.75), (-0.06, 1.0))
    return figure


def heap(fp3, folder, scene):
    recording, picture = folder / "heap.h5", folder / "heap.png"
    ws.call(fp3, ws.put(folder, scene.text(folder), scene.name), "--steps", 384, "--every", 384, "--output", recording)
    subprocess.run([fp3, "view", recording, "--png", picture, "--width", "1280", "--height", "720", "--turn", "30:15", "--box", "0:3.2,0:2.4,0:3.2"],
                   check=True, capture_output=True)
    pixels = matplotlib.image.imread(picture)[160:160 + HEIGHT, 138:138 + WIDTH]
    figure = Figure(figsize=(WIDTH / DPI, HEIGHT / DPI), dpi=DPI)
    figure.figimage(pixels)
    return figure


def plummer(fp3, folder, scene):
    found, _ = record(fp3, folder, scene, "--every", 2, "--steps", 320)
    x, v = ws.vectors(found, "x"), ws.vectors(found, "v")
    speed = np.linalg.norm(v[-1], axis=1)
    paint = matplotlib.colormaps["plasma"](np.clip(speed / 1.4, 0, 0.9))
    figure, axes = canvas()
    trails(axes, x[..., 0], x[..., 1], paint, 0.7)
    axes.scatter(x[-1, :, 0], x[-1, :, 1], s=7, c=paint, linewidths=0, zorder=3)
    bare(axes, (-3.2, 3.2), (-1.8, 1.8))
    return figure


def dam(fp3, folder, scene):
    found, times = record(fp3, folder, scene, "--every", 200)
    figure, axes = canvas(nrows=2, ncols=2)
    for one, n in zip(axes.flat, (0, 5, 8, 11)):
        x, y = found["x_x"][n], found["x_y"][n]
        speed = np.hypot(found["v_x"][n], found["v_y"][n])
        one.plot([0, 0, 4.6], [2.15, 0, 0], color=INK, linewidth=1)
        one.scatter(x, y, s=9, c=matplotlib.colormaps["viridis"](np.clip(speed / 2.4, 0, 0.92)), linewidths=0)
        one.text(4.5, 1.9, f"t = {times[n]:.1f}", ha="right")
        bare(one, (-0.1, 4.6), (-0.1, 2.2))
    return figure


def eight(fp3, folder, scene):
    """A film of one period, which goes on where it began."""
    found, _ = record(fp3, folder, scene, "--every", 8)
    x = ws.vectors(found, "x")[:-1]
    for n in range(0, len(x), len(x) // FRAMES):
        figure, axes = canvas(360)
        figure.set_dpi(DPI * SMALLER)
        axes.plot(x[:, 0, 0], x[:, 0, 1], color=FAINT, linewidth=0.7)
        way = np.roll(x, 150 - n, axis=0)[:151]
        trails(axes, way[..., 0], way[..., 1], COLOURS, 3)
        axes.scatter(x[n, :, 0], x[n, :, 1], s=90, c=COLOURS[:3], zorder=3, linewidths=0)
        bare(axes, (-1.2, 1.2), (-0.45, 0.45))
        yield figure


def chain(fp3, folder, scene):
    """Where each mass is, over time: a wave that meets its end and comes back."""
    found, times = record(fp3, folder, scene, "--every", 2, "--steps", 768)
    figure, axes = canvas()
    shown = axes.imshow(found["u"].T, aspect="auto", origin="lower", cmap="RdBu_r", vmin=-0.06, vmax=0.06, extent=(0, times[-1], -0.5, 33.5),
                        interpolation="nearest")
    axes.set(xlabel="time, s", ylabel="mass", yticks=[0, 8, 16, 24, 33])
    bar = figure.colorbar(shown, ax=axes, shrink=0.8, pad=0.01, label="displacement, m")
    bar.outline.set_visible(False)
    return figure


# ---- each for itself ----

def pendulums(fp3, folder, scene):
    """Every tenth pendulum while they fan out, and over time where the lower bob of each is."""
    found, times = record(fp3, folder, scene, "--every", 16)
    x1, y1, x2, y2 = errors.bobs(found)
    paint = colours_of("turbo", x1.shape[1], 0.05, 0.95)
    figure, (near, long) = canvas(340, ncols=2, width_ratios=[0.8, 2])
    n, some = np.searchsorted(times, 4.5), slice(None, None, 10)
    rods = np.stack([np.stack([np.zeros_like(x1[n]), x1[n], x2[n]], -1), np.stack([np.zeros_like(y1[n]), y1[n], y2[n]], -1)], -1)
    near.add_collection(LineCollection(rods[some], colors=paint[some], linewidths=1.3))
    near.scatter(x1[n, some], y1[n, some], s=9, c=paint[some], linewidths=0, zorder=3)
    near.scatter(x2[n, some], y2[n, some], s=30, c=paint[some], linewidths=0, zorder=3)
    near.plot([0], [0], "o", color=INK, markersize=5, zorder=4)
    near.set_title("40 of them after 4.5 s")
    bare(near, (-2.1, 2.1), (-2.1, 2.1))
    long.add_collection(LineCollection(np.stack([np.broadcast_to(times[:, None], x2.shape), x2], -1).transpose(1, 0, 2), colors=paint, linewidths=0.8, antialiaseds=False))
    long.set(xlim=(2, times[-1]), ylim=(-2.05, 2.05), xlabel="time, s", title="all 400: the lower bob, from left to right")
    return figure


def arenstorf(fp3, folder, scene):
    times = np.linspace(0, 17.0652165601579625588917206249, 3001)
    found, _ = record(fp3, folder, scene, "--times", ",".join(f"{t!r}" for t in times))
    x, y = found["r_x"][:, 0], found["r_y"][:, 0]
    figure, axes = canvas()
    points = np.stack([x, y], -1)
    speed = np.hypot(found["v_x"][:, 0], found["v_y"][:, 0])
    paint = matplotlib.colormaps["plasma_r"](np.clip(0.15 + speed / 2.2, 0, 0.95))
    axes.add_collection(LineCollection(np.stack([points[:-1], points[1:]], 1), colors=paint[:-1], linewidths=3, capstyle="round"))
    axes.scatter(x[::30], y[::30], s=42, c=paint[::30], linewidths=0, zorder=2)
    for place, name, size, colour in ((-0.012277471, "earth", 26, COLOURS[1]), (1 - 0.012277471, "moon", 12, "#666666")):
        axes.plot([place], [0], "o", color=colour, markersize=size, zorder=3)
        axes.annotate(name, (place, 0), (0, -24 if name == "earth" else -17), textcoords="offset points", ha="center", fontsize=9)
    bare(axes, (-1.9, 1.9), (-1.2, 1.2))
    return figure


def van_der_pol(fp3, folder, scene):
    times = np.unique(np.concatenate([np.linspace(0, 2000, 401), 807.1 + np.linspace(-0.6, 0.6, 201)]))
    found, times = record(fp3, folder, scene, "--times", ",".join(f"{float(t)!r}" for t in times))
    x = found["x"][:, 0]
    figure, (long, near) = canvas(400, ncols=2, width_ratios=[2, 1])
    for one in (long, near):
        one.fill_between(times, x, where=x >= 0, color=COLOURS[0], alpha=0.25, linewidth=0, interpolate=True)
        one.fill_between(times, x, where=x <= 0, color=COLOURS[1], alpha=0.25, linewidth=0, interpolate=True)
        line = np.stack([times, x], -1)
        one.add_collection(LineCollection(np.stack([line[:-1], line[1:]], 1), colors=np.where(x[:-1, None] >= 0, *map(matplotlib.colors.to_rgba, COLOURS[:2])),
                                          linewidths=3.5, capstyle="round"))
        one.set(xlabel="time", ylim=(-2.4, 2.4), yticks=[-2, -1, 0, 1, 2])
    long.set(ylabel="x", xlim=(0, 2000), title="creeps for hundreds of units ...")
    near.set(xlim=(806.5, 807.7), xticks=[806.5, 807, 807.5], title="... and jumps within one")
    near.ticklabel_format(useOffset=False)
    return figure


def duffing(fp3, folder, scene):
    """At four times of the drive's period: the attractor is stretched and folded. The colour is the place, so it shows what goes where."""
    found, _ = record(fp3, folder, scene, "--every", 64)
    x, v = found["x"], found["v"]
    figure, axes = canvas(nrows=2, ncols=2)
    start = x[80:-4:4]
    for number, one in enumerate(axes.flat):
        one.scatter(x[80 + number:len(x) - 4 + number:4], v[80 + number:len(v) - 4 + number:4], s=1.6, c=start, cmap="turbo", vmin=-1.5, vmax=1.6, linewidths=0)
        one.text(0.02, 0.96, ("the drive at its most", "a quarter of a period later", "half a period later", "three quarters later")[number],
                 va="top", transform=one.transAxes)
        one.set(xlim=(-1.75, 1.75), ylim=(-1.2, 1.45))
        one.set_axis_off()
    return figure


def ships(fp3, folder, scene):
    found, times = record(fp3, folder, scene, "--every", 2)
    figure, axes = canvas()
    paint = colours_of("viridis", 48)
    for k in range(48):
        alive = found["life"][:, k] == 1
        axes.plot(times[alive], found["s"][alive, k] / 1000, color=paint[k], linewidth=1.1)
    axes.set(xlabel="time, s", ylabel="way, km", xlim=(0, 512), ylim=(0, None))
    scale = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(120, 360), matplotlib.colors.ListedColormap(paint))
    bar = figure.colorbar(scale, ax=axes, shrink=0.8, pad=0.01, label="thrust, kN")
    bar.outline.set_visible(False)
    return figure


def lorenz(fp3, folder, scene):
    found, times = record(fp3, folder, scene, "--every", 8)
    paint = colours_of("turbo", 2000, 0.05, 0.95)
    figure, axes = canvas(400, ncols=4)
    for one, t in zip(axes, LORENZ):
        n = np.searchsorted(times, t)
        one.plot(found["x"][:, 0], found["z"][:, 0], color="#c3c8d2", linewidth=0.7, zorder=0)
        one.scatter(found["x"][n], found["z"][n], s=9, c=paint, linewidths=0)
        one.set_title(f"t = {t:g}", y=-0.04)
        bare(one, (-21, 21), (0, 50))
    return figure


# ---- rigid bodies ----

def bodies(fp3, folder, scene, times, box, rows=1, height=HEIGHT):
    """A picture for each time. What is dynamic has the colours of the rainbow, paler while it sleeps."""
    found = recorded.Recording(fp3, folder, scene, "--times", ",".join(map(str, times)))
    paint = np.tile(matplotlib.colors.to_rgba("#6b7079"), (len(found.moves), 1))
    paint[found.moves] = colours_of("turbo", found.moves.sum(), 0.08, 0.92)
    figure, axes = canvas(height, nrows=rows, ncols=len(times) // rows)
    for n, one in enumerate(np.atleast_1d(axes).flat):
        of, outlines = zip(*found.shapes(n))
        asleep = found.moves & (found.rest[n] < 0)
        faces = np.where(asleep[:, None], 0.5 + 0.5 * paint, paint)
        one.add_collection(PolyCollection(outlines, facecolors=faces[list(of)], edgecolors=INK, linewidths=0.4))
        one.text(0.98, 0.96, f"{times[n]:g} s", ha="right", va="top", transform=one.transAxes)
        bare(one, *box)
    return figure


def pyramid(fp3, folder, scene):
    return bodies(fp3, folder, scene, (0.5, 1, 2, 10), ((-32, 48), (-1.5, 43.5)), rows=2)


def ragdolls(fp3, folder, scene):
    return bodies(fp3, folder, scene, (1, 1.5, 2.5, 10), ((-0.6, 26), (-0.5, 14.2)), rows=2)


def car(fp3, folder, scene):
    return bodies(fp3, folder, scene, (1, 4, 6), ((-20, 20), (-8, 5)), rows=3, height=540)


def dominoes(fp3, folder, scene):
    return bodies(fp3, folder, scene, (2, 4, 8), ((-35, 35), (-1.5, 4)), rows=3, height=300)


def tumbler(fp3, folder, scene):
    return bodies(fp3, folder, scene, (0, 3, 10), ((-15, 15), (-15, 15)), height=330)


def views(fp3, folder, scene, times, rows, height, *look):
    """A picture of fp3 view for each time."""
    recording, columns = folder / f"{scene.name}.h5", len(times) // rows
    ws.call(fp3, ws.put(folder, scene.text(folder), scene.name), "--output", recording, "--times", ",".join(map(str, times)))
    figure = Figure(figsize=(WIDTH / DPI, height / DPI), dpi=DPI)
    for n, time in enumerate(times):
        picture, left, above = folder / "view.png", n % columns * WIDTH // columns, n // columns * height // rows
        subprocess.run([fp3, "view", recording, "--png", picture, "--at", str(time), "--width", str(WIDTH // columns), "--height", str(height // rows), *look],
                       check=True, capture_output=True)
        figure.figimage(matplotlib.image.imread(picture), left, height - height // rows - above)
        figure.text((left + WIDTH // columns - 12) / WIDTH, 1 - (above + 12) / height, f"{time:g} s", ha="right", va="top")
    return figure


def castle(fp3, folder, scene):
    return views(fp3, folder, scene, (0, 0.75, 1.5, 8), 2, 500, "--see", "-3:7,0:6,-4:4", "--turn=-25:15")


def top(fp3, folder, scene):
    return views(fp3, folder, scene, (0, 1.75, 2, 2.25, 2.5, 2.75, 3, 5.5), 2, 400)


def tippe(fp3, folder, scene):
    return views(fp3, folder, scene, (0, 2, 3, 4, 5, 8), 2, 500, "--see", "-1.5:1.5,0:2.2,-1.5:1.5")


# ---- all of them ----

def pixels(figure):
    drawn = FigureCanvasAgg(figure)
    drawn.draw()
    return PIL.Image.fromarray(np.asarray(drawn.buffer_rgba())).convert("RGB")


def draw(fp3, folder, scene, path):
    """path: the PNG. Several figures make a film, an animated PNG, whose pictures share their colours."""
    found = globals()[scene.name](fp3, folder, scene)
    if isinstance(found, Figure):
        pixels(found).save(path, optimize=True)
        return
    frames = [pixels(figure) for figure in found]
    first = frames[0].quantize(48, dither=0)
    frames = [first] + [frame.quantize(palette=first, dither=0) for frame in frames[1:]]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=1000 // 12, loop=0, optimize=True)
