#!/usr/bin/env python3
"""Sets what a board with a picture shows (docs/pictures.md): writes registers of rtl/video over the board's serial line.

    examples/pictures.py PORT [--baud 115200] [--bits 18] WORD...

A WORD is NAME=VALUE for a register, in the order in which they are written; across and down take ORIGIN,SCALE. `disc=R` writes the shape of a
disc of radius R, up to 7; `on`, `off` and `hold` write control. If there is a register to write, `off` and 16 colours come first. --bits: address
bits of the processor.
"""

import argparse
import math
import os
import select
import sys
import termios
import time
import tty
import zlib

NAMES = ("id", "control", "x", "y", "upper", "step", "objects", "across", "down", "shape", "background", "warning", "status", "frames", "taken", "outside", "numberless",
         "unfinished")
REGISTERS = {name: 4 * at for at, name in enumerate(NAMES)}
COLOURS, ID = 0x80, 0x46505630
PALETTE = (0xf4a261, 0xe9c46a, 0x2a9d8f, 0x8ab17d, 0x61a5c2, 0xa9d6e5, 0xb5838d, 0xe5989b, 0xffcdb2, 0x90be6d, 0x43aa8b, 0x577590, 0xf9c74f, 0xf3722c, 0xb8c0ff, 0xffd6ff)
CONTROLS = {"off": 0, "on": 1, "hold": 3}
TRIES, SECONDS = 5, 0.2


def disc(radius):
    """The shape of a disc: digit d is for the rows d above and below its centre."""
    return sum(1 + math.isqrt(radius * radius + radius - d * d) << 4 * d for d in range(radius + 1))


def word(text):
    """The name of a register and its word."""
    name, _, value = text.partition("=")
    try:
        if text in CONTROLS:
            return "control", CONTROLS[text]
        if name in ("across", "down"):
            origin, scale = (int(part, 0) for part in value.split(","))
            if -2048 <= origin < 2048 and -128 <= scale < 128:
                return name, (scale & 255) << 16 | origin & 0xffff
        elif name == "disc" and 0 <= int(value) <= 7:
            return "shape", disc(int(value))
        elif name in NAMES[2:12] and 0 <= int(value, 0) < 1 << 32:
            return name, int(value, 0)
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(f"'{text}': expected on, off, hold, disc=0 to 7, across=ORIGIN,SCALE, down=ORIGIN,SCALE, or a register and its word")


class Line:
    """A board's serial line: requests and their answers (docs/board.md)."""

    def __init__(self, port, baud):
        rate = getattr(termios, f"B{baud}", None)
        if rate is None:
            raise OSError(f"no rate of {baud} baud here")
        self.port, self.sequence, self.file = port, 0, os.open(port, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.file)
        settings = termios.tcgetattr(self.file)
        settings[4] = settings[5] = rate
        termios.tcsetattr(self.file, termios.TCSANOW, settings)

    def packet(self):
        """The next packet from the line, without its CRC; None: it took too long."""
        data, until = b"", time.monotonic() + SECONDS
        while time.monotonic() < until:
            if select.select([self.file], [], [], until - time.monotonic())[0]:
                byte = os.read(self.file, 1)
                if byte != b"\xc0":
                    data += byte
                    continue
                body = data.replace(b"\xdb\xdc", b"\xc0").replace(b"\xdb\xdd", b"\xdb")
                if len(body) > 5 and zlib.crc32(body[:-4]).to_bytes(4, "little") == body[-4:]:
                    return body[:-4]
                data = b""
        return None

    def ask(self, address, value=None):
        """A word is written, or read and returned."""
        self.sequence = self.sequence + 1 & 255
        body = bytes([self.sequence, 0x80 if value is not None else 0]) + address.to_bytes(4, "little") + (b"" if value is None else value.to_bytes(4, "little"))
        body += zlib.crc32(body).to_bytes(4, "little")
        for _ in range(TRIES):
            os.write(self.file, b"\xc0" + body.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc") + b"\xc0")
            while (answer := self.packet()) is not None:
                if answer[0] == self.sequence:
                    if answer[1]:
                        raise OSError(f"{self.port}: the board refused address 0x{address:x}" + ("" if value is None else f" = 0x{value:x}"))
                    return int.from_bytes(answer[2:6], "little")
        raise OSError(f"{self.port}: no answer")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port")
    parser.add_argument("words", metavar="WORD", nargs="*", type=word)
    parser.add_argument("--baud", type=int, default=115200, help="default: %(default)s")
    parser.add_argument("--bits", type=int, default=18, help="default: %(default)s")
    args = parser.parse_args()
    window = 1 << args.bits
    try:
        line = Line(args.port, args.baud)
        if line.ask(window) != ID:
            raise OSError(f"{args.port}: there is no picture at address 0x{window:x}: is it a board with a picture, and are --bits right?")
        first = [(REGISTERS["control"], 0), *((COLOURS + 4 * i, colour) for i, colour in enumerate(PALETTE))]
        writes = [(REGISTERS[name], value) for name, value in args.words]
        for address, value in writes if all(name == "control" for name, _ in args.words) else first + writes:
            line.ask(window + address, value)
    except OSError as error:
        sys.exit(f"pictures.py: {error}")


if __name__ == "__main__":
    main()
