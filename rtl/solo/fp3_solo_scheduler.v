// SPDX-License-Identifier: Apache-2.0
// fp3_solo_scheduler: the paper's workload scheduler. Fetches a program, issues its instructions
// and writes the results back, for one object in the shortest time. (For many: tile_scheduler.)
//
// Purpose   The paper's instruction memory, register file and busy flags. An instruction issues
//           when none of its registers is flagged, its unit takes it, and the register file will
//           be free for its result. In order.
//
//           stage    fetch  fetch | issue         | operands       | unit ... | write
//                    memory word  | busy flags,   | register file  |          | register file,
//                                 | slot          | or bypass      |          | retirement
//
// Latency   The first instruction issues 4 cycles after start_i and has its operands in the cycle
//           after; then one instruction per cycle at best. A result is bypassed to a waiting
//           operand in the cycle in which it is written (BYPASS), or is read from the register file
//           two cycles later.
// Hazard    The host accesses (host_*) an idle scheduler only: running_o is low.
`default_nettype none
`include "front/decoded.vh"
`include "unit/socket.vh"
`include "gen/settings.vh"
module fp3_solo_scheduler #(
`include "config/config.vh"
) (
    input  wire                            clk_i,
    input  wire                            rst_i,
    // A run
    input  wire                            start_i,
    input  wire                            stop_i,
    input  wire [`FP3_SETTINGS_W-1:0]          settings_i,
    output wire                            running_o,
    output wire                            illegal_o,       // the word at issue_pc_o ends the run
    // The host: program, registers, constants (above the registers)
    input  wire                            host_program_i,  // write host_wdata_i there
    input  wire                            host_write_i,
    input  wire [PROGRAM_W-1:0]            host_program_addr_i,
    input  wire [REGISTER_W:0]          host_addr_i,
    input  wire [31:0]                     host_wdata_i,
    output wire [31:0]                     host_rdata_o,    // one cycle after host_addr_i
    // The arithmetic unit
    output wire                            chain_o,
    output wire [`FP3_OPERANDS_W-1:0]          operands_o,
    output wire [31:0]                     add_a_o,         // the adder's, of a chained product, too
    output wire [31:0]                     add_b_o,
    input  wire                            chain_soon_i,
    input  wire [31:0]                     chain_z_i,
    input  wire [`FP3_RESULT_W-1:0]            sum_i,
    input  wire [`FP3_RESULT_W-1:0]            product_i,
    // What happens in this cycle, for counters and traces
    output wire                            issue_o,
    output wire                            issue_add_o,
    output wire                            issue_mul_o,
    output wire                            issue_chain_o,
    output wire [PROGRAM_W-1:0]            issue_pc_o,
    output wire [31:0]                     issue_word_o,
    output wire                            stall_fetch_o,
    output wire                            stall_dependency_o,
    output wire                            stall_unit_o,
    output wire                            stall_writeback_o,
    output wire                            stall_drain_o,
    output wire                            retire_o,
    output wire [REGISTER_W-1:0]           retire_register_o,
    output wire [31:0]                     retire_value_o,
    output wire [4:0]                      retire_flags_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"

    // Fetch and decode ------------------------------------------------------------------------
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS = settings_i;
    wire                 advance;
    wire                 fetched, fetch_empty;
    wire [PROGRAM_W-1:0] fetch_pc;
    wire [31:0]          fetch_word;
    wire [4:0]           unused_fetch;                    // visits are for many objects

    fp3_fetch #(.CONFIG(CONFIG)) u_fetch (
        .clk_i(clk_i), .rst_i(rst_i),
        .write_i(host_program_i), .write_addr_i(host_program_addr_i), .write_word_i(host_wdata_i),
        .start_i(start_i), .stop_i(stop_i || illegal_o),
        .settings_i(settings_i), .steps_i(setting_steps),
        .skip_i(1'b0), .more_i(1'b0), .again_o(unused_fetch[4]),
        .jump_i(1'b0), .jump_on_i(1'b0), .jump_begins_i(1'b0), .jump_pc_i({PROGRAM_W{1'b0}}),
        .advance_i(advance), .valid_o(fetched), .pc_o(fetch_pc), .word_o(fetch_word),
        .marks_o(unused_fetch[3:0]),
        .empty_o(fetch_empty));

    wire [`FP3_DECODED_W-1:0] decoded;
    reg  [`FP3_DECODED_W-1:0] decoded_q;
    fp3_decode #(.CONFIG(CONFIG)) u_decode (.word_i(fetch_word), .decoded_o(decoded));
    reg                  valid_q;
    reg  [PROGRAM_W-1:0] pc_q;
    reg  [31:0]          word_q;

    always @(posedge clk_i) begin
        if (rst_i || stop_i || illegal_o) valid_q <= 1'b0;
        else if (advance)                 valid_q <= fetched;
        if (advance) begin
            decoded_q <= decoded;
            pc_q      <= fetch_pc;
            word_q    <= fetch_word;
        end
    end

    `FP3_DECODED_FIELDS
    assign `FP3_DECODED = decoded_q;
    wire unused_fields = &{to_sleep, to_memory, st, lds, each, next, ldn, ldl, takes, flips, phase, twice, halve};      // for many objects

    // The result of fp_value reaches the adder in place of a product. With FUSED it has the latency
    // of a product, and a multiply-add that of a sum: then a sum alone is c + 1 * b, and c is also
    // a.
    wire valued = choice != CHOICE_NONE;
    wire alone  = to_add && !valued;
    wire sums   = alone || (FUSED != 0 && to_chain);
    wire muls   = to_mul || (FUSED != 0 && valued);
    wire chains = FUSED == 0 && (to_chain || valued);
    localparam SUM_LATENCY = FUSED != 0 ? PRODUCT_LATENCY + ADD_LATENCY : ADD_LATENCY;

    // Issue -----------------------------------------------------------------------------------
    wire             blocked, taken, in_flight_none, write, write_mul;
    wire [REG_W-1:0] write_d;
    wire [1:0]       a_bypass, b_bypass, c_bypass;

    wire unit_busy = sums && chain_soon_i;
    wire port_busy = taken || (WRITEBACK_STALL != 0 && write);
    wire issue     = valid_q && legal && !blocked && !unit_busy && !port_busy && !stop_i;
    assign advance   = !valid_q || issue;
    assign illegal_o = valid_q && !legal;

    fp3_scoreboard #(.REG_W(REG_W), .BYPASS(BYPASS), .CHAIN(FUSED == 0 && (CHAIN != 0 || VALUES != 0)),
                 .ADD_LATENCY(SUM_LATENCY), .MUL_LATENCY(MUL_LATENCY)) u_scoreboard (
        .clk_i(clk_i), .rst_i(rst_i),
        .issue_i(issue), .to_add_i(sums), .to_mul_i(muls), .to_chain_i(chains),
        .reads_c_i(FUSED != 0 || chains),
        .d_i({1'b0, d}), .a_i(a), .b_i(b), .c_i(c),
        .blocked_o(blocked), .taken_o(taken),
        .a_bypass_o(a_bypass), .b_bypass_o(b_bypass), .c_bypass_o(c_bypass),
        .write_o(write), .write_mul_o(write_mul), .write_d_o(write_d), .empty_o(in_flight_none));

    // Operands --------------------------------------------------------------------------------
    wire [31:0] a_value, b_value, c_value;
    wire [31:0] sum, product;
    wire [4:0]  sum_flags, product_flags;
    assign {sum_flags, sum, product_flags, product} = {sum_i, product_i};
    wire [31:0] result = write_mul ? product : sum;
    reg  [1:0]  a_bypass_q, b_bypass_q, c_bypass_q;    // a_bypass_q = 3: the constant 1.0
    reg  [1:0]  add_a_q, add_b_q;      // likewise; of add_a_q 3 is a chain's addend
    reg         chain_q, subtract_q;
    reg  [CHOICE_W-1:0] choice_q;

    fp3_regfile #(.ADDR_W(REG_W)) u_regfile (
        .clk_i(clk_i),
        .write_i(write || host_write_i),
        .write_addr_i(write ? write_d : host_addr_i),
        .write_value_i(write ? result : host_wdata_i),
        .a_addr_i(running_o ? a : host_addr_i), .b_addr_i(b), .c_addr_i(c),
        .a_value_o(a_value), .b_value_o(b_value), .c_value_o(c_value));
    assign host_rdata_o = a_value;

    always @(posedge clk_i) begin
        a_bypass_q <= FUSED != 0 && alone ? 2'b11 : a_bypass;
        b_bypass_q <= b_bypass;
        c_bypass_q <= c_bypass;
        add_a_q    <= chain_soon_i ? 2'b11 : a_bypass;
        add_b_q    <= chain_soon_i ? 2'b10 : b_bypass;
        subtract_q <= subtract;
        chain_q    <= !rst_i && issue && chains;
        choice_q   <= choice;
    end

    `FP3_OPERANDS_FIELDS
    assign {operands_choice, operands_subtract, operands_twice, operands_halve} = {choice_q, subtract_q, 2'b00};
    assign operands_x = FUSED != 0 && &a_bypass_q ? BITS_ONE : a_bypass_q[1] ? product : a_bypass_q[0] ? sum : a_value;
    assign operands_y = b_bypass_q[1] ? product : b_bypass_q[0] ? sum : b_value;
    assign operands_z = c_bypass_q[1] ? product : c_bypass_q[0] ? sum : c_value;
    assign operands_o = `FP3_OPERANDS;
    assign chain_o = chain_q;
    assign add_a_o = add_a_q[1] ? (add_a_q[0] ? chain_z_i : product) : add_a_q[0] ? sum : a_value;
    assign add_b_o = add_b_q[1] ? product : add_b_q[0] ? sum : b_value;

    // A run ends when nothing is left to fetch, to issue or to write ---------------------------
    reg running_q;
    always @(posedge clk_i)
        if (rst_i)        running_q <= 1'b0;
        else if (start_i) running_q <= 1'b1;
        else if (fetch_empty && !valid_q && in_flight_none) running_q <= 1'b0;
    assign running_o = running_q;

    // Every running cycle is an issue or exactly one stall ---------------------------------------
    wire waiting = running_q && valid_q && !issue;
    assign issue_o            = issue;
    assign issue_add_o        = issue && to_add;
    assign issue_mul_o        = issue && to_mul;
    assign issue_chain_o      = issue && to_chain;
    assign issue_pc_o         = pc_q;
    assign issue_word_o       = word_q;
    assign stall_fetch_o      = running_q && !valid_q && !fetch_empty;
    assign stall_drain_o      = (running_q && !valid_q && fetch_empty)
                             || (waiting && (!legal || stop_i));
    assign stall_dependency_o = waiting && legal && !stop_i && blocked;
    assign stall_unit_o       = waiting && legal && !stop_i && !blocked && unit_busy;
    assign stall_writeback_o  = waiting && legal && !stop_i && !blocked && !unit_busy;
    assign retire_o           = write;
    assign retire_register_o  = write_d[REGISTER_W-1:0];
    wire unused = write_d[REGISTER_W];
    assign retire_value_o     = result;
    assign retire_flags_o     = write_mul ? product_flags : sum_flags;

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i && running_o && (host_write_i || host_program_i)) begin
            $display("%m: the host writes while a program runs"); $stop;
        end else if (!rst_i && issue && sums && chain_soon_i) begin
            $display("%m: a sum meets a chained product in the adder"); $stop;
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
