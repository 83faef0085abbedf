// SPDX-License-Identifier: Apache-2.0
// replay: runs a recorded host session on the processor, and checks every answer.
//
// Purpose   The same requests that the C host sent to the processor under Verilator, sent to it
//           under any other simulator, or to its netlist: one record, the same bits, the same cycles.
// Use       iverilog -DTOP=fp3_array -DSCHEDULERS=4 -DLANES=4 ...: the schedulers of all tiles, and the
//           lanes of all schedulers; 1 and 1 unless they are given. -DSTREAMS=2 with DUAL. -DADDRESS_W: the bits of
//           s_axi_awaddr, 18 unless it is given.
//           vvp replay.vvp +session=FILE [+waves=FILE.fst] [+limit=CYCLES] [+resets=N [+seed=S]]
//           FILE, a line each, hexadecimal:
//               w address data     write, answered without error
//               r address data     read, answered with this data
//               p address mask     read until no bit of mask is set
//               h high low         the hash of all retirements so far (FNV-1a, 64 bits, over lane,
//                                  row, register, value, flags, each as 32 bits, low byte first;
//                                  lanes of one cycle in their order)
//               s address 0        read and shown: a line `address data`, or `address error`
//               z cycles length    so many cycles later, reset for `length` cycles
//               e lines 0          the end: how many lines are in front of it. A file that was cut off has none
//           With +resets the session is replayed twice. In between it begins N times, with pauses on the
//           bus, and each time a reset of one to four cycles ends it at a random moment, in transfers too.
//           The second replay takes the cycles of the first, and has its hash.
// Unknown   From the first reset on, no ready or valid, no response and no interrupt may be x, and nothing
//           that issues or retires; nor a word that the session reads, as it reads what was written.
// Result    A closing line PASS or FAIL, with the cycles since the last reset; $fatal, hence a non-zero
//           exit, on FAIL.
`default_nettype none
`timescale 1ns/1ps
`ifndef FP3_TOP
`define FP3_TOP fp3_single
`endif
`ifndef FP3_SCHEDULERS
`define FP3_SCHEDULERS 1
`endif
`ifndef FP3_LANES
`define FP3_LANES 1
`endif
`ifndef FP3_ADDRESS_W
`define FP3_ADDRESS_W 18
`endif
`ifndef FP3_STREAMS
`define FP3_STREAMS 1
`endif
module replay;
`include "gen/isa.vh"
`include "gen/registers.vh"
    reg clk = 1'b0, rst = 1'b1;
    always #5 clk = !clk;

    // The bus: without a transfer its payload is unknown.
    localparam SCHEDULERS = `FP3_SCHEDULERS, STREAMS = `FP3_STREAMS, ISSUES = SCHEDULERS * STREAMS, RETIRES = `FP3_LANES * STREAMS;
    localparam ADDRESS_W = `FP3_ADDRESS_W;
    reg                  awvalid = 1'b0, wvalid = 1'b0, arvalid = 1'b0, bready = 1'b0, rready = 1'b0;
    reg  [31:0]          awaddr, araddr, wdata;
    reg  [3:0]           wstrb;
    wire                 awready, wready, arready, bvalid, rvalid, irq;
    wire [1:0]           bresp, rresp;
    wire [31:0]          rdata;
    // The trace: STREAMS parts for each scheduler and for each lane, the first in the low bits.
    wire [ISSUES-1:0]     issue_valid;
    wire [16*ISSUES-1:0]  issue_pc, issue_context;
    wire [32*ISSUES-1:0]  issue_word;
    wire [RETIRES-1:0]    retire_valid;
    wire [16*RETIRES-1:0] retire_context;
    wire [32*RETIRES-1:0] retire_object, retire_value;
    wire [6*RETIRES-1:0]  retire_register;
    wire [5*RETIRES-1:0]  retire_flags;

    `FP3_TOP dut (
        .s_axi_aclk(clk), .s_axi_aresetn(!rst),
        .s_axi_awaddr(awaddr[ADDRESS_W-1:0]), .s_axi_awprot(3'b000), .s_axi_awvalid(awvalid), .s_axi_awready(awready),
        .s_axi_wdata(wdata), .s_axi_wstrb(wstrb), .s_axi_wvalid(wvalid), .s_axi_wready(wready),
        .s_axi_bresp(bresp), .s_axi_bvalid(bvalid), .s_axi_bready(bready),
        .s_axi_araddr(araddr[ADDRESS_W-1:0]), .s_axi_arprot(3'b000), .s_axi_arvalid(arvalid), .s_axi_arready(arready),
        .s_axi_rdata(rdata), .s_axi_rresp(rresp), .s_axi_rvalid(rvalid), .s_axi_rready(rready),
        .irq(irq),
`ifdef FP3_MASTER           // memory that never answers: nothing is moved in a session
        .m_axi_awready(1'b0), .m_axi_wready(1'b0), .m_axi_bid(1'b0), .m_axi_bresp(2'b00), .m_axi_bvalid(1'b0),
        .m_axi_arready(1'b0), .m_axi_rid(1'b0), .m_axi_rdata(32'd0), .m_axi_rresp(2'b00), .m_axi_rlast(1'b0), .m_axi_rvalid(1'b0),
`endif
        .issue_valid_o(issue_valid), .issue_pc_o(issue_pc), .issue_context_o(issue_context),
        .issue_word_o(issue_word),
        .retire_valid_o(retire_valid), .retire_context_o(retire_context),
        .retire_object_o(retire_object), .retire_register_o(retire_register),
        .retire_value_o(retire_value), .retire_flags_o(retire_flags));

    // What a wave viewer shows as text: the instruction that a scheduler issues, the result that a
    // lane writes.
    function [8*4-1:0] operand(input [6:0] field);
        operand = {field[6] ? "k" : "r", 8'h30 + field[5:0] / 8'd10, 8'h30 + field[5:0] % 8'd10, " "};
    endfunction
    genvar s, n;
    generate
        for (s = 0; s < ISSUES; s = s + 1) begin : g_scheduler
            wire        valid          = issue_valid[s];
            wire [15:0] pc             = issue_pc[16*s +: 16];
            wire [15:0] context_number = issue_context[16*s +: 16];
            wire [31:0] word           = issue_word[32*s +: 32];
            wire [4:0]  code           = word[OP_HI:OP_LO];
            reg  [8*32-1:0] text = "";
            always @* begin
                text = "";
                if (valid)
                    text = {mnemonic(code), " ", operand({1'b0, word[D_HI:D_LO]}),
                            has_a(code) ? operand(word[A_HI:A_LO]) : "    ",
                            has_b(code) ? operand(word[B_HI:B_LO]) : "    ",
                            has_c(code) ? operand(word[C_HI:C_LO]) : "    "};
            end
        end
        for (n = 0; n < RETIRES; n = n + 1) begin : g_lane
            wire        valid          = retire_valid[n];
            wire [15:0] context_number = retire_context[16*n +: 16];
            wire [31:0] row            = retire_object[32*n +: 32];
            wire [5:0]  register       = retire_register[6*n +: 6];
            wire [31:0] value          = retire_value[32*n +: 32];
            wire [4:0]  flags          = retire_flags[5*n +: 5];
            reg  [8*32-1:0] text = "";
            always @* begin
                text = "";
                if (valid) $sformat(text, "r%0d=%h", register, value);
            end
        end
    endgenerate

    // The hash of everything that was ever written.
    localparam [63:0] FNV_OFFSET = 64'hcbf29ce484222325, FNV_PRIME = 64'h00000100000001b3;
    reg [63:0] hash = FNV_OFFSET;
    function [63:0] fnv(input [63:0] from, input [31:0] word);
        integer i;
        begin
            fnv = from;
            for (i = 0; i < 4; i = i + 1) fnv = (fnv ^ {56'd0, word[8*i +: 8]}) * FNV_PRIME;
        end
    endfunction
    integer lane;
    reg     rst_q = 1'b1;                      // the processor has its reset a cycle later
    always @(posedge clk) rst_q <= rst;

    // What may not be unknown, once there was a reset.
    reg  known = 1'b0;
    wire unknown_bus   = ^{awready, wready, arready, bvalid, rvalid, irq} === 1'bx
                      || (bvalid !== 1'b0 && ^bresp === 1'bx) || (rvalid !== 1'b0 && ^rresp === 1'bx);
    reg  unknown_trace;
    integer part;
    always @* begin
        unknown_trace = ^{issue_valid, retire_valid} === 1'bx;
        for (part = 0; part < ISSUES; part = part + 1)
            if (issue_valid[part] && ^{issue_pc[16*part +: 16], issue_context[16*part +: 16], issue_word[32*part +: 32]} === 1'bx)
                unknown_trace = 1'b1;
        for (part = 0; part < RETIRES; part = part + 1)
            if (retire_valid[part] && ^{retire_context[16*part +: 16], retire_object[32*part +: 32],
                    retire_register[6*part +: 6], retire_value[32*part +: 32], retire_flags[5*part +: 5]} === 1'bx)
                unknown_trace = 1'b1;
    end
    always @(posedge clk) begin
        if (!rst && !rst_q) known <= 1'b1;
        if (known && unknown_bus)             fail("the bus or the interrupt is unknown");
        if (known && !rst_q && unknown_trace) fail("something unknown issues or retires");
    end

    always @(posedge clk)
        for (lane = 0; lane < RETIRES; lane = lane + 1)
            if (!rst_q && retire_valid[lane]) begin
                hash = fnv(hash, lane / STREAMS);
                hash = fnv(hash, retire_object[32*lane +: 32]);
                hash = fnv(hash, {26'd0, retire_register[6*lane +: 6]});
                hash = fnv(hash, retire_value[32*lane +: 32]);
                hash = fnv(hash, {27'd0, retire_flags[5*lane +: 5]});
            end

    integer cycles = 0, limit = 1000000;
    always @(posedge clk) begin
        cycles <= cycles + 1;
        if (cycles > limit) fail("the cycle limit was reached; +limit=CYCLES moves it");
    end

    reg [8*256-1:0] session, waves;
    reg [8*8-1:0]   kind;
    reg [31:0]      x, y;
    integer         file, line, fields, checks, round;
    reg             ended;
    integer         resets = 0, seed = 1, fresh_cycles;
    reg [63:0]      fresh_hash;

    task fail(input [8*64-1:0] why);
        begin
            $display("FAIL %0s:%0d: %0s", session, line, why);
            $fatal(1);
        end
    endtask

    // One transfer and its response; what the master says changes at the falling edge.
    reg [31:0] answer;
    reg        refused, goes, data_goes;
    integer    lag, data_lag;                  // cycles before the address, and before the data
    task draw_lags;
        begin
            lag      = round < resets ? $unsigned($random(seed)) % 4 : 0;
            data_lag = round < resets ? $unsigned($random(seed)) % 4 : 0;
        end
    endtask
    task write_word(input [31:0] addr, input [31:0] data);
        begin
            draw_lags;
            @(negedge clk);
            while (lag >= 0 || data_lag >= 0 || awvalid || wvalid) begin
                if (lag == 0)      {awvalid, awaddr} = {1'b1, addr};
                if (data_lag == 0) {wvalid, wdata, wstrb} = {1'b1, data, 4'b1111};
                lag      = lag - 1;
                data_lag = data_lag - 1;
                @(posedge clk) {goes, data_goes} = {awvalid && awready, wvalid && wready};
                @(negedge clk);
                if (goes)      {awvalid, awaddr} = {1'b0, 32'bx};
                if (data_goes) {wvalid, wdata, wstrb} = {1'b0, 36'bx};
            end
            while (!bvalid) @(negedge clk);
            refused = bresp != 2'b00;
            draw_lags;
            repeat (lag) @(negedge clk);
            bready  = 1'b1;
            @(negedge clk) bready = 1'b0;
        end
    endtask
    task read_word(input [31:0] addr);
        begin
            draw_lags;
            repeat (lag + 1) @(negedge clk);
            {arvalid, araddr} = {1'b1, addr};
            while (arvalid) begin
                @(posedge clk) goes = arready;
                @(negedge clk);
                if (goes) {arvalid, araddr} = {1'b0, 32'bx};
            end
            while (!rvalid) @(negedge clk);
            {answer, refused} = {rdata, rresp != 2'b00};
            repeat (data_lag) @(negedge clk);
            rready = 1'b1;
            @(negedge clk) rready = 1'b0;
        end
    endtask
    task access(input write, input [31:0] addr, input [31:0] data);
        begin
            if (write) write_word(addr, data);
            else       read_word(addr);
            if (refused !== 1'b0 && kind != "s") fail("the processor answered with an error");
        end
    endtask

    // The session from its first line. A reset ends it anywhere: nothing that it needs is outside of it.
    task play;
        begin
            line   = 0;
            checks = 0;
            ended  = 1'b0;
            hash   = FNV_OFFSET;
            fields = $rewind(file);
            fields = $fscanf(file, " %s %h %h", kind, x, y);
            while (fields == 3) begin
                line = line + 1;
                if (ended) fail("a line follows the end");
                case (kind)
                    "w": access(1'b1, x, y);
                    "r": begin
                        access(1'b0, x, 32'd0);
                        checks = checks + 1;
                        if (answer !== y) begin
                            $display("address %h: expected %h, got %h", x, y, answer);
                            fail("a read differs from the record");
                        end
                    end
                    "p": begin
                        access(1'b0, x, 32'd0);
                        while ((answer & y) != 32'd0) access(1'b0, x, 32'd0);
                    end
                    "h": begin
                        checks = checks + 1;
                        if (hash !== {x, y}) begin
                            $display("hash of retirements: expected %h%h, got %h", x, y, hash);
                            fail("the retirements differ from the record");
                        end
                    end
                    "s": begin
                        access(1'b0, x, 32'd0);
                        checks = checks + 1;
                        if (refused) $display("%h error", x);
                        else           $display("%h %h", x, answer);
                    end
                    "z": begin
                        repeat (x) @(negedge clk);
                        reset(y);
                    end
                    "e": begin
                        if (x != line - 1) fail("the end counts other lines: some are missing");
                        ended = 1'b1;
                    end
                    default: fail("a line is not w, r, p, h, s, z or e");
                endcase
                fields = $fscanf(file, " %s %h %h", kind, x, y);
            end
        end
    endtask
    task reset(input [31:0] length);
        begin
            rst = 1'b1;
            {awvalid, awaddr, wvalid, wdata, wstrb, arvalid, araddr} = {1'b0, 32'bx, 1'b0, 36'bx, 1'b0, 32'bx};
            {bready, rready} = 2'b00;
            repeat (length) @(negedge clk);
            rst    = 1'b0;
            cycles = 0;
        end
    endtask

    initial begin
        if (!$value$plusargs("session=%s", session)) begin
            $display("FAIL: +session=FILE is missing");
            $fatal(1);
        end
        if ($value$plusargs("waves=%s", waves)) begin
            $dumpfile(waves);
            $dumpvars(0, replay);
        end
        if ($value$plusargs("limit=%d", limit)) $display("limit: %0d cycles", limit);
        fields = $value$plusargs("resets=%d", resets) + $value$plusargs("seed=%d", seed);
        line = 0;
        file = $fopen(session, "r");
        if (file == 0) fail("the file cannot be opened");
        round = resets;
        repeat (4) @(negedge clk);
        reset(32'd1);
        play;
        if (resets > 0) begin
            {fresh_cycles, fresh_hash} = {cycles, hash};
            for (round = 0; round < resets; round = round + 1) begin
                fork
                    play;
                    begin
                        repeat ($unsigned($random(seed)) % (2 * fresh_cycles)) @(negedge clk);
                        disable play;
                    end
                join
                reset($unsigned($random(seed)) % 4 + 1);
            end
            play;
            if ({cycles, hash} !== {fresh_cycles, fresh_hash}) begin
                $display("%0d cycles and hash %h, fresh %0d and %h", cycles, hash, fresh_cycles, fresh_hash);
                fail("a run after resets differs from a fresh one");
            end
        end
        if (!$feof(file)) begin line = line + 1; fail("the line cannot be read"); end
        if (!ended) fail("the session has no end: it was cut off");
        if (checks == 0) fail("the session checks nothing");
        $display("PASS %0s: %0d lines, %0d answers checked, %0d cycles, hash %h",
                 session, line, checks, cycles, hash);
        $finish;
    end
`include "gen/mnemonic.vh"
`include "gen/operands.vh"
endmodule
`default_nettype wire
