"""What fp3_pictures is to show (docs/pictures.md), computed from words of positions alone; and how a host says it."""

import dataclasses
import functools
import math
import pathlib
import struct
import sys
import zlib
from fractions import Fraction

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples"))
from pictures import COLOURS, PALETTE, REGISTERS, disc  # noqa: E402, F401


@dataclasses.dataclass(frozen=True)
class Frame:
    """Pixels and lines: visible, front porch, sync, back porch; clock cycles in a pixel; bits of the number of objects."""
    across: tuple = (640, 16, 96, 48)
    down: tuple = (480, 10, 2, 33)
    ticks: int = 2
    objects_w: int = 10
    spare: int = 10

    def parameters(self):
        names = ("WIDTH", "H_FRONT", "H_SYNC", "H_BACK", "HEIGHT", "V_FRONT", "V_SYNC", "V_BACK")
        return dict(zip(names, self.across + self.down)) | {"TICKS": self.ticks, "OBJECTS_W": self.objects_w, "SPARE": self.spare}

    def pixels(self):
        return sum(self.across) * sum(self.down)

    @functools.cache
    def flags(self):
        """Of each pixel of a frame from the first visible one: bit 0 visible, 1 and 2 the syncs, which are negative."""
        width, columns = self.across[0], sum(self.across)
        sync = width + self.across[1]
        begins = (self.down[0] + self.down[1] - 1) * columns + sync     # the edges of both are one
        out = bytearray()
        for at in range(self.pixels()):
            x, y = at % columns, at // columns
            out.append((x < width and y < self.down[0]) | (not sync <= x < sync + self.across[2]) << 1
                       | (not begins <= at < begins + self.down[2] * columns) << 2)
        return bytes(out)


@dataclasses.dataclass(frozen=True)
class View:
    """The settings of a picture, and 16 colours."""
    x: int
    y: int
    step: int
    objects: int
    upper: int = 0
    x_origin: int = 0
    x_scale: int = 0
    y_origin: int = 0
    y_scale: int = 0
    shape: int = 1
    shift: int = 0
    background: int = 0x101820
    warning: int = 0xff0000
    palette: tuple = PALETTE

    def words(self):
        place = lambda origin, scale: (scale & 255) << 16 | origin & 0xffff
        return {"x": self.x, "y": self.y, "upper": self.upper, "step": self.step, "objects": self.shift << 16 | self.objects,
                "across": place(self.x_origin, self.x_scale), "down": place(self.y_origin, self.y_scale),
                "shape": self.shape, "background": self.background, "warning": self.warning}


def pixel(word, scale, origin, down):
    """None: infinite, or no number."""
    value = struct.unpack("<f", struct.pack("<I", word))[0]
    if not math.isfinite(value):
        return None
    away = math.floor(Fraction(value) * Fraction(2) ** scale)
    return origin - away if down else origin + away


def places(view, words):
    """Of each object column and row, or None; words: x and y of each."""
    for x, y in words:
        found = pixel(x, view.x_scale, view.x_origin, False), pixel(y, view.y_scale, view.y_origin, True)
        yield None if None in found else found


def draw(view, frame, found, background):
    """The picture as rows of (red, green, blue) bytes: found are the places of objects in their order."""
    width, height = frame.across[0], frame.down[0]
    rows = [[background] * width for _ in range(height)]
    for number, place in enumerate(found):
        if place is None:
            continue
        colour = view.palette[number >> view.shift & 15]
        for d in range(-7, 8):
            if 0 <= place[1] + d < height:
                n = view.shape >> 4 * abs(d) & 15
                for x in range(max(0, place[0] - n + 1), min(width, place[0] + n)):
                    rows[place[1] + d][x] = colour
    return [b"".join(colour.to_bytes(3, "big") for colour in row) for row in rows]


def counts(view, frame, found):
    """Objects whose centre is outside of the picture; objects without a place."""
    there = [place for place in found if place]
    centred = sum(0 <= x < frame.across[0] and 0 <= y < frame.down[0] for x, y in there)
    return len(there) - centred, len(found) - len(there)


def png(rows):
    """A PNG file of such rows: with a palette, as there are few colours."""
    width, colours = len(rows[0]) // 3, sorted({row[i:i + 3] for row in rows for i in range(0, len(row), 3)})
    number = {colour: i for i, colour in enumerate(colours)}
    data = b"".join(b"\0" + bytes(number[row[i:i + 3]] for i in range(0, len(row), 3)) for row in rows)

    def chunk(kind, body):
        return len(body).to_bytes(4, "big") + kind + body + zlib.crc32(kind + body).to_bytes(4, "big")
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(rows), 8, 3, 0, 0, 0)) + chunk(b"PLTE", b"".join(colours))
            + chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b""))
