"""The UART bridge between a line with bad packets and a bus with errors: what it does is what bridge_model.py says, and no more."""

import random
import subprocess

import pytest

from bugs import few
from bridge_model import ADDRESSES, BEYOND, END, Host, checked, escaped, heard, request

TOP = ("-f", "rtl/fp3.f", "-y", "rtl/board")


def icarus(root, tmp_path, divisor=4, permille=1000, broken=None):
    """The bench for Icarus, perhaps with a bug: (module, right, wrong)."""
    first = []
    if broken:
        module, right, wrong = broken
        text = (root / f"rtl/board/fp3_{module}.v").read_text()
        assert text.count(right) == 1, f"fp3_{module}.v does not have this once: {right!r}"
        first = [tmp_path / f"fp3_{module}.v"]
        first[0].write_text(text.replace(right, wrong))
    bench = tmp_path / "bridge.vvp"
    built = subprocess.run(["iverilog", "-g2012", "-Wall", "-Wno-timescale", "-s", "bridge_bench", f"-Pbridge_bench.DIVISOR={divisor}",
                            f"-Pbridge_bench.PERMILLE={permille}", "-c", "rtl/fp3.f", "-y", "rtl/board", "-o", bench,
                            "tests/board/bridge_bench.v", *first], cwd=root, capture_output=True, text=True)
    assert built.returncode == 0 and not built.stderr, built.stderr
    return ["vvp", "-n", bench]


def verilated(root, tmp_path):
    """The same bench for Verilator: longer to build, 40 times as fast."""
    built = subprocess.run(["verilator", "--binary", "--timing", "-O3", "-Wno-fatal", "--timescale", "1ns/1ps", *TOP, "--top-module", "bridge_bench",
                            "--Mdir", tmp_path / "cc", "-CFLAGS", "-O1", "tests/board/bridge_bench.v"], cwd=root, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    return [tmp_path / "cc/Vbridge_bench"]


def plays(bench, host, tmp_path, seed=0):
    script, told = tmp_path / "in", tmp_path / "out"
    script.write_text("\n".join(host.script) + "\n")
    subprocess.run([*bench, f"+in={script}", f"+out={told}", f"+seed={seed}"], check=True, capture_output=True, timeout=3000)
    transfers, answers, last = heard(told.read_text())
    return transfers, answers, last


def right(bench, host, tmp_path, seed=0):
    transfers, answers, last = plays(bench, host, tmp_path, seed)
    assert last == "end", f"{last}, after {len(answers)} of {host.good} answers"
    expected = host.expected()
    for what, got, wanted in (("transfer", transfers, expected[0]), ("answer", answers, expected[1])):
        differ = [k for k, pair in enumerate(zip(got, wanted)) if pair[0] != pair[1]]
        assert not differ, f"{what} {differ[0]}: expected {wanted[differ[0]]}, got {got[differ[0]]}"
        assert len(got) == len(wanted), f"expected {len(wanted)} {what}s, got {len(got)}"
    assert len(answers) == host.good


def noisy(seed, most, bad):
    """Good packets between bad ones, until there were so many bad ones."""
    host = Host(random.Random(seed), most)
    while host.bad < bad:
        for _ in range(host.chance.randrange(5)):
            host.disturb()
        host.ask_something()
    host.script.append(f"i {host.chance.randrange(100):x}")
    host.ask(request(99, 0, count=1))
    return host


def rules(most=64):
    """Each rule of docs/board.md once."""
    host = Host(random.Random(1))
    host.ask(request(0, 8, count=1), begin=False)
    host.bytes([END] * 3)                                  # packets without bytes
    start = request(1, 8, words=[0xc0db0001, 0xdbc00002, 3])
    host.ask(start)
    host.ask(start)                                        # the answer was lost: answered again, not executed again
    host.ask(request(2, 12, words=[4]))
    host.ask(request(2, 8, count=3))
    host.ask(request(2, 12, words=[5]))                    # a read came in between: executed
    host.ask(request(2, 8, count=3))
    host.overrun(request(4, 8, count=2), request(5, 8, words=[6]))
    failing = request(6, BEYOND - 8, words=[7, 8, 9, 10])
    host.ask(failing)                                      # an error at the third word, and again
    host.ask(failing)
    host.ask(request(7, BEYOND - 8, count=4))
    host.ask(request(8, BEYOND, count=2))                  # no word before the error
    host.ask(request(9, ADDRESSES + 8, words=[11]))        # addresses that the bus does not have
    host.ask(request(10, 2**32 - 4, count=2))
    host.ask(request(11, 8, count=3))
    host.script += ["g 1", "i 7", "k c", "k 3", "i 28"]    # noise between packets, over before the next one begins
    host.ask(request(12, 0, words=[0x01010101 * k for k in range(most)]))
    host.bytes([0, *escaped(checked(request(13, 0, words=[1]))), END])
    host.ask(request(14, 0, count=most))
    return host


def test_every_good_packet_between_bad_ones_is_answered(root, tmp_path, long):
    seed, bad = 1, 10_000 if long else 30
    host = noisy(seed, 64 if long else 3, bad)
    assert host.bad >= bad and host.good > bad / 4
    right(verilated(root, tmp_path) if long else icarus(root, tmp_path), host, tmp_path, seed)


@pytest.mark.parametrize("divisor, permille", [(16, 965), (16, 1035), (5, 1000), (104, 965), (104, 1035)])
def test_a_host_whose_clock_is_another_one(root, tmp_path, divisor, permille):
    host = Host(random.Random(1))
    host.ask(request(0x55, 8, words=[0xff0055aa]))
    right(icarus(root, tmp_path, divisor, permille), host, tmp_path)


RESET_BENCH = """
`timescale 1ns/1ps
module fp3_board_clock #(parameter PIN_HZ = 0, parameter CLOCK_HZ = 0) (input wire clk_pin, output wire clk_o, output wire good_o);
    assign clk_o = clk_pin, good_o = bench.good;
endmodule
module fp3_board #(parameter DIVISOR = 0, parameter ADDRESS_W = 0)
    (input wire clk_i, input wire rst_i, input wire uart_rxd, output wire uart_txd, output wire irq);
    integer cycles = 0;
    always @(posedge clk_i) begin
        cycles = rst_i ? cycles + 1 : 0;
        if (!rst_i) bench.started = 1'b1;
        if (bench.started && cycles == 4) bench.again = 1'b1;
    end
endmodule
module bench;
    reg  clk = 1'b0, good = 1'b0, started = 1'b0, again = 1'b0;
    wire light;
    always #5 clk = !clk;
    fp3_board_top dut (.clk_pin(clk), .uart_rxd(1'b1), .uart_txd(), .light(light));
    initial begin
        #98 good = 1'b1; #200 good = 1'b0; #10 good = 1'b1; #200 $display("started %b, again %b, light %b", started, again, light);
        $finish;
    end
endmodule
"""


def test_a_clock_that_is_bad_for_a_cycle_resets_all(root, tmp_path):
    (tmp_path / "bench.v").write_text(RESET_BENCH)
    subprocess.run(["iverilog", "-g2012", "-o", tmp_path / "bench.vvp", tmp_path / "bench.v", root / "rtl/board/fp3_board_top.v"], check=True)
    done = subprocess.run(["vvp", "-n", tmp_path / "bench.vvp"], capture_output=True, text=True)
    assert done.stdout.startswith("started 1, again 1, light 1"), done.stdout


BUGS = {
    "a command's bit 6 is not looked at": ("request_rx", "byte_i[6] ? BAD : BODY", "BODY"),
    "a packet that is too long": ("request_rx", "default:  next = BAD;", "default:  next = WHOLE;"),
    "the CRC's word is stored": ("request_rx", "word_q != 7'd0 && word_q != last;", "word_q != 7'd0;"),
    "the CRC is not looked at": ("request_rx", "state_q == WHOLE && crc_q == RIGHT", "state_q == WHOLE"),
    "packets are heard during an answer": ("request_rx", "next = listen_i ? COMMAND : BAD;", "next = COMMAND;"),
    "a bad stop bit is a good one": ("uart_rx", "if (sample) bad_q <= !line;", "bad_q <= 1'b0;"),
    "a break is bytes without end": ("uart_rx", "line_q[2] && !line;", "!line;"),
    "a broken escape is an end": ("slip_rx", "(escape_q && !escaped)", "1'b0"),
    "an escape goes on behind an end": ("slip_rx", "escape_q <= escape;", "escape_q <= escape || (escape_q && end_o);"),
    "0xDB is not escaped": ("slip_tx", "byte_i == END || byte_i == ESCAPE)", "byte_i == END)"),
    "a write is executed again": ("transact", "kept_q && write_i && sequence_i", "1'b0 && write_i && sequence_i"),
    "a read does not make it forget": ("transact", "kept_q <= write_i;", "kept_q <= kept_q || write_i;"),
    "words go on after an error": ("transact", "failed || word_q == last_i", "word_q == last_i"),
    "the number of an error is from 0": ("transact", "status_q <= number;", "status_q <= number - 7'd1;"),
    "addresses are cut": ("transact", "outside = |address_q[31:ADDRESS_W]", "outside = 1'b0"),
    "an answer has a word too many": ("answer_tx", "after == words_i", "word_q == words_i"),
    "a CRC goes on from the answer before": ("answer_tx", "state_q == OPEN ? 32'hffffffff", "state_q == OPEN && 1'b0 ? 32'hffffffff"),
}


def small(most):
    """The packets that show all of BUGS: as rules(), then one bad packet of each kind that they are about."""
    host = rules(most)
    whole = checked(request(20, 8, words=[1]))
    for line in (whole[:-1] + bytes([whole[-1] ^ 1]), whole + b"\0", checked(bytes([20, 0xc0]) + whole[2:-4])):
        host.bytes([END, *escaped(line), END])
    host.bytes([END, *escaped(checked(request(20, 8, words=[0xdb]))).replace(b"\xdb\xdd", b"\xdb\0"), END])
    host.bytes([END, *escaped(whole)])
    host.script += [f"x {END:02x}"]
    host.bytes([END, 0xdb, END])
    host.ask(request(21, 8, count=1), begin=False)
    host.script.append("k f")                              # a bit of silence after a break is enough
    host.ask(request(22, 8, words=[0xdb]))
    host.ask(request(23, 8, count=1))
    return host


def test_each_rule(root, tmp_path, long):
    right(icarus(root, tmp_path), small(64 if long else 2), tmp_path)


@pytest.mark.parametrize("bug", few((name, name) for name in BUGS))
def test_a_bug_is_seen(root, tmp_path, bug, long):
    with pytest.raises(AssertionError) as seen:
        right(icarus(root, tmp_path, broken=BUGS[bug]), small(64 if long else 2), tmp_path)
    assert "once" not in str(seen.value)
