"""How many transfers the bus accepts before the master takes a response, as docs/integration.md says."""

import re
import subprocess

import pytest

import simulate

BENCH = """`default_nettype none
module accepted;
    parameter GAP = 0;                  // cycles between two transfers
    reg clk = 0, rst_n = 0, ask = 0, reads = 0;
    wire awready, wready, arready;
    integer writes_n = 0, reads_n = 0, i;
    always #1 clk = !clk;
    `FP3_TOP u_top (.s_axi_aclk(clk), .s_axi_aresetn(rst_n), .s_axi_awaddr(18'h20000), .s_axi_awprot(3'd0), .s_axi_awvalid(ask && !reads), .s_axi_awready(awready),
        .s_axi_wdata(32'd0), .s_axi_wstrb(4'hf), .s_axi_wvalid(ask && !reads), .s_axi_wready(wready), .s_axi_bready(1'b0),
        .s_axi_araddr(18'h20000), .s_axi_arprot(3'd0), .s_axi_arvalid(ask && reads), .s_axi_arready(arready), .s_axi_rready(1'b0));
    always @(posedge clk) begin
        if (ask && !reads && awready) writes_n <= writes_n + 1;
        if (ask && reads && arready) reads_n <= reads_n + 1;
    end
    initial begin
        repeat (8) @(negedge clk);
        rst_n = 1;
        repeat (20) @(negedge clk);
        repeat (2) begin
            for (i = 0; i < 60; i = i + 1) begin
                ask = 1;
                @(negedge clk);
                ask = GAP == 0;
                repeat (GAP) @(negedge clk);
            end
            reads = 1;
        end
        $display("%0d %0d", writes_n, reads_n);
        $finish;
    end
endmodule
"""


def accepted(root, folder, config, gap):
    (folder / "bench.v").write_text(BENCH)
    for line in (["iverilog", "-g2012", "-s", "accepted", f"-Paccepted.GAP={gap}", f"-DFP3_TOP=fp3_{config}", "-c", "rtl/fp3.f", "-o", folder / "bench.vvp", folder / "bench.v",
                  simulate.top(config)], ["vvp", "-n", folder / "bench.vvp"]):
        done = subprocess.run(line, cwd=root, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stdout + done.stderr
    return [int(word) for word in done.stdout.split()]


@pytest.mark.parametrize("config", ["many", "single"])
def test_so_many_transfers_wait_for_their_response(root, tmp_path, config):
    page = " ".join((root / "docs/integration.md").read_text(encoding="utf-8").split())
    said = re.search(r"With a store the bus accepts at least (\d+) writes and (\d+) reads .*? without a store (\d+) of each", page)
    wanted = [int(said[1]), int(said[2])] if config == "many" else [int(said[3])] * 2
    found = [accepted(root, tmp_path, config, gap) for gap in (0, 30)]          # one after the other, and one by one
    assert [min(column) for column in zip(*found)] == wanted, found
