"""examples/pictures.py against a board that answers as docs/board.md says: each word is written once and in order, and what gets no answer is
sent again. And a whole board, as its line sees it."""

import os
import pathlib
import pty
import shutil
import subprocess
import sys
import threading
import tty

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "board"))
from bridge_model import checked, escaped, request, unescaped  # noqa: E402

import picture  # noqa: E402
import pictures  # noqa: E402
import simulated_board  # noqa: E402

WINDOW = 1 << 18


class Board(threading.Thread):
    """The end of a line with a picture behind it: what was written, by address."""

    def __init__(self, line, refuses=(), loses=0, ident_word=0x46505630):
        super().__init__(daemon=True)
        self.line, self.refuses, self.loses, self.ident_word, self.written, self.kept = line, refuses, loses, ident_word, [], None
        self.start()

    def run(self):
        data = b""
        while True:
            try:
                data += os.read(self.line, 1000)
            except OSError:
                return
            *packets, data = data.split(b"\xc0")
            for packet in packets:
                body = unescaped(packet)
                if body and body == checked(body[:-4]):
                    self.obey(body[:-4])

    def obey(self, body):
        address, write = int.from_bytes(body[2:6], "little"), body[1] >= 0x80
        refused = address in self.refuses
        if write and self.kept != body[0] and not refused:
            self.written.append((address, int.from_bytes(body[6:10], "little")))
        self.kept = body[0] if write else None
        if self.loses and write:
            self.loses -= 1
            return
        words = b"" if write or refused else self.ident_word.to_bytes(4, "little")
        os.write(self.line, b"\xc0" + escaped(checked(bytes([body[0], refused]) + words)) + b"\xc0")


def start(root, *arguments, **board):
    line, end = pty.openpty()
    tty.setraw(end)
    try:
        board = Board(line, **board)
        return board, subprocess.run([sys.executable, root / "examples/pictures.py", os.ttyname(end), *arguments], capture_output=True, text=True, timeout=60)
    finally:
        os.close(end)
        os.close(line)


def test_words_are_written(root):
    """An address and a word with bytes that are escaped, too."""
    board, done = start(root, "x=0x200c0", "objects=300", "across=-5,9", "down=440,-3", "disc=7", "background=0xc0dbdc", "on", loses=1)
    assert done.returncode == 0, done.stderr
    colours = [(picture.COLOURS + 4 * i, colour) for i, colour in enumerate(picture.PALETTE)]
    wanted = [("control", 0), *colours, ("x", 0x200c0), ("objects", 300), ("across", 0x9fffb), ("down", 0xfd01b8), ("shape", 0x35677888),
              ("background", 0xc0dbdc), ("control", 1)]
    assert board.written == [(WINDOW + (picture.REGISTERS[at] if isinstance(at, str) else at), value) for at, value in wanted]


def test_a_picture_is_held(root):
    board, done = start(root, "hold")
    assert done.returncode == 0 and board.written == [(WINDOW + 4, 3)], done.stderr


@pytest.mark.parametrize("arguments, board, code, said", [
    (["z=1"], {}, 2, "'z=1': expected on, off"), (["disc=8"], {}, 2, "'disc=8'"), (["across=3000,0"], {}, 2, "'across=3000,0'"),
    (["frames=1"], {}, 2, "'frames=1'"),
    (["step=3"], {"refuses": [WINDOW + 0x14]}, 1, "the board refused address 0x40014 = 0x3"),
    ([], {"ident_word": 5}, 1, "there is no picture at address 0x40000"),
    (["off"], {"loses": 9}, 1, "no answer"), (["--baud", "7"], {}, 1, "no rate of 7 baud here"),
])
def test_what_is_wrong_is_told(root, arguments, board, code, said):
    _, done = start(root, *arguments, **board)
    assert done.returncode == code and said in done.stderr and "Traceback" not in done.stderr, done.stderr


def test_a_port_that_is_not_there(root):
    done = subprocess.run([sys.executable, root / "examples/pictures.py", "/nowhere"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "/nowhere" in done.stderr and "Traceback" not in done.stderr


def test_a_whole_board(root, build, tmp_path):
    """The processor and the picture behind one line, and words of DVI; the first ones are of the blanking, in which no sync is on."""
    bench, sent = tmp_path / "board.vvp", tmp_path / "in"
    rooms = [word for name in ("board", "video") for word in ("-y", f"rtl/{name}")]
    said = subprocess.run(["iverilog", "-g2012", "-Wall", "-Wno-timescale", "-DFP3_TOP=fp3_single", "-s", "board_bench", "-o", bench, "-c", "rtl/fp3.f",
                           *rooms, "-y", build / "rtl", "tests/video/board_bench.v"], cwd=root, capture_output=True, text=True)
    assert said.returncode == 0 and not said.stderr, said.stderr
    steps, ours = 0x20, WINDOW + picture.REGISTERS["shape"]
    packets = [request(0, WINDOW, count=1), request(1, 0, count=1), request(2, steps, words=[1234]), request(3, ours, words=[0x12345678]),
               request(4, steps, count=1), request(5, ours, count=2), request(6, 2 * WINDOW, count=1), request(7, 0x7c, count=1)]
    sent.write_text("".join(f"{byte:02x}\n" for packet in packets for byte in [*escaped(checked(packet)), 0xc0]))
    out = subprocess.run(["vvp", "-n", bench, f"+in={sent}"], capture_output=True, text=True, timeout=100, check=True).stdout.split("\n")
    data = bytes(int(line[2:], 16) for line in out if line.startswith("b "))
    answers = [unescaped(packet)[:-4] for packet in data.split(b"\xc0") if packet]
    words = [(answer[0], answer[1], [int.from_bytes(answer[i:i + 4], "little") for i in range(2, len(answer), 4)]) for answer in answers]
    fp3 = words[1][2][0]
    assert words == [(0, 0, [0x46505630]), (1, 0, [fp3]), (2, 0, []), (3, 0, []), (4, 0, [1234]), (5, 0, [0x12345678, 0]), (6, 1, []), (7, 1, [])]
    assert fp3 >> 8 == 0x465033
    assert [line[2:] for line in out if line.startswith("w ")] == ["1101010100" * 2 + "1010101011"] * 3


DEVICE = """module fp3_pictures_clock #(parameter PIN_HZ = 4, CLOCK_HZ = 4) (input wire clk_pin, output wire clk_o, bit_clk_o, good_o);
    reg [1:0] good_q = 2'd0;
    always @(posedge clk_pin) if (!good_q[1]) good_q <= good_q + 2'd1;
    assign {clk_o, bit_clk_o, good_o} = {clk_pin, clk_pin, good_q[1]};
endmodule
module fp3_pictures_serial (input wire clk_i, rst_i, word_i, bit_clk_i, input wire [39:0] words_i, output wire [3:0] lines_o);
    assign lines_o = words_i[3:0];
endmodule
"""


@pytest.mark.long
def test_fp3_run_on_a_board_with_a_picture(root, build, fp3, tmp_path):
    """fp3_pictures_top in the place of the board that fp3 board simulates: objects have the words of the engine `fast`, and positions are read."""
    made, installed = tmp_path / "made", tmp_path / "fp3/lib/fp3"
    (tmp_path / "device.v").write_text(DEVICE)
    installed.mkdir(parents=True)
    for path in (build / "lib/fp3").glob("*.so"):
        (installed / path.name).symlink_to(path)
    (installed / "fp3_board_world.so").unlink()
    (tmp_path / "fp3/bin").mkdir()
    shutil.copy(build / "bin/fp3", tmp_path / "fp3/bin/fp3")
    include = subprocess.run(["verilator", "--getenv", "VERILATOR_ROOT"], capture_output=True, text=True, check=True).stdout.strip() + "/include"
    rooms = [word for name in ("rtl/board", "rtl/video", build / "rtl") for word in ("-y", name)]
    subprocess.run(["verilator", "-f", "rtl/fp3.f", "-Wno-fatal", "-O3", "--x-assign", "fast", "--x-initial", "unique", "--cc", "--prefix", "Vfp3_board_top",
                    "--top-module", "fp3_pictures_top", "--Mdir", made, "-DFP3_TOP=fp3_world", "-GPIN_HZ=4", "-GCLOCK_HZ=4", "-GBAUD=1", *rooms,
                    "rtl/video/fp3_pictures_top.v", tmp_path / "device.v"], cwd=root, check=True, capture_output=True)
    (made / "all.cpp").write_text("".join(f'#include "{path.name}"\n' for path in sorted(made.glob("V*.cpp"))))
    subprocess.run(["g++", "-std=c++17", "-O1", "-fPIC", "-shared", "-DFP3_DIVISOR=4", *(f"-I{root / name}" for name in ("sim", "sw", "sw/include")),
                    "-isystem", made, "-isystem", include, "-isystem", f"{include}/vltstd", "-o", installed / "fp3_board_world.so", made / "all.cpp",
                    root / "sim/board_shim.cpp", *(build / f"obj/verilator/{name}.o" for name in ("verilated", "verilated_threads"))], check=True)
    with simulated_board.board(tmp_path / "fp3/bin/fp3", "--config", "world") as (_, port):
        words = ["x=0x20000", "y=0x20004", "upper=0x8000", "step=32", "objects=250", "across=140,5", "down=440,5", "disc=7", "on"]
        subprocess.run([sys.executable, root / "examples/pictures.py", port, *words], check=True, timeout=60)
        taken = [pictures.Line(port, 115200).ask(WINDOW + picture.REGISTERS["taken"])]
        for name in ("chain", "bridge"):
            run = [fp3, "run", "--scene", root / f"programs/world/{name}.scene", "--steps", "3", "--output"]
            subprocess.run([*run, tmp_path / "board.csv", "--engine", "board", "--port", port], check=True, capture_output=True, timeout=300)
            subprocess.run([*run, tmp_path / "fast.csv", "--engine", "fast", "--config", "world"], check=True, capture_output=True, timeout=60)
            assert (tmp_path / "board.csv").read_bytes() == (tmp_path / "fast.csv").read_bytes(), name
            taken.append(pictures.Line(port, 115200).ask(WINDOW + picture.REGISTERS["taken"]))
    assert taken[0] < taken[1] < taken[2]
