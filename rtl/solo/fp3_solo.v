// SPDX-License-Identifier: Apache-2.0
// fp3_solo: the paper's machine: one scheduler with busy flags and its arithmetic unit, for one
// object in the shortest time. (For many: tile.)
//
// Purpose   The paper's instruction memory, register file and busy flags. An instruction issues, in
//           order, when none of its registers is flagged, its unit takes it, and the register file
//           will be free for its result. Results are used as soon as they exist.
//
//           stage    fetch  fetch | issue         | operands       | unit ... | write
//                    memory word  | busy flags,   | register file  |          | register file,
//                                 | slot          | or bypass      |          | retirement
//
//           Trace ports (issue_*, retire_*) are for simulation.
// Latency   The first instruction issues 4 cycles after a start and has its operands in the cycle
//           after; then one instruction per cycle at best. A result is bypassed to a waiting
//           operand in the cycle in which it is written (BYPASS), or is read from the register file
//           two cycles later. An access: host_port.
`default_nettype none
`include "host/answer.vh"
`include "front/decoded.vh"
`include "unit/socket.vh"
`include "gen/settings.vh"
`include "gen/events.vh"
module fp3_solo #(
`include "config/config.vh"
) (
    input  wire        clk_i,
    input  wire        rst_i,
    // Host port
    input  wire        req_valid_i,
    input  wire        req_write_i,
    input  wire [23:0] req_addr_i,
    input  wire [31:0] req_wdata_i,
    output wire [`FP3_ANSWER_W-1:0] answer_o,
    output wire        irq_o,
    // Trace
    output wire        issue_valid_o,
    output wire [15:0] issue_pc_o,
    output wire [31:0] issue_word_o,
    output wire        retire_valid_o,
    output wire [5:0]  retire_register_o,
    output wire [31:0] retire_value_o,
    output wire [4:0]  retire_flags_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"
`include "host/lane_host.vh"

    // The host accesses program, registers and constants (above the registers) between runs. In
    // reset a request may still be anything: its registers have no reset.
    wire                 start, stop, illegal, program_write, access, access_write;
    wire [PROGRAM_W-1:0] program_addr;
    wire [2:0]           space;
    wire [19:0]          address;
    wire [31:0]          host_wdata, host_rdata;
    reg                  running_q;
    reg  [PROGRAM_W-1:0] pc_q;
    wire                 host_write = access && access_write && !rst_i;
    wire [REGISTER_W:0]  host_addr  = {space == HOST_CONSTANT, address[REGISTER_W-1:0]};
    wire [1:0]           unused_part;                     // of a store
    wire [`FP3_SETTINGS_W-1:0] settings;
    `FP3_SETTINGS_FIELDS
    `FP3_EVENTS_FIELDS
    assign `FP3_SETTINGS = settings;
    fp3_host_port #(.CONFIG(CONFIG)) u_host_port (
        .clk_i(clk_i), .rst_i(rst_i),
        .req_valid_i(req_valid_i), .req_write_i(req_write_i), .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
        .answer_o(answer_o), .irq_o(irq_o),
        .start_o(start), .stop_o(stop), .settings_o(settings), .part_o(unused_part),
        .running_i(running_q), .illegal_i(illegal), .illegal_pc_i(pc_q), .half_i(1'b0), .overfull_i(1'b0), .no_room_i(1'b0), .raised_i(1'b0),
        .flags_i(retire_flags_o & {5{retire_valid_o}}), .events_i(`FP3_EVENTS),
        .program_write_o(program_write), .program_addr_o(program_addr),
        .access_o(access), .write_o(access_write), .space_o(space), .addr_o(address),
        .wdata_o(host_wdata), .rdata_i(host_rdata));

    // Fetch and decode ------------------------------------------------------------------------
    wire                 advance;
    wire                 fetched, fetch_empty;
    wire [PROGRAM_W-1:0] fetch_pc;
    wire [31:0]          fetch_word;
    wire [4:0]           unused_fetch;                    // visits are for many objects

    fp3_fetch #(.CONFIG(CONFIG)) u_fetch (
        .clk_i(clk_i), .rst_i(rst_i),
        .write_i(program_write), .write_addr_i(program_addr), .write_word_i(host_wdata),
        .start_i(start), .stop_i(stop || illegal),
        .settings_i(settings), .steps_i(setting_steps),
        .skip_i(1'b0), .more_i(1'b0), .again_o(unused_fetch[4]),
        .jump_i(1'b0), .jump_on_i(1'b0), .jump_begins_i(1'b0), .jump_pc_i({PROGRAM_W{1'b0}}),
        .advance_i(advance), .valid_o(fetched), .pc_o(fetch_pc), .word_o(fetch_word),
        .marks_o(unused_fetch[3:0]), .empty_o(fetch_empty));

    wire [`FP3_DECODED_W-1:0] decoded;
    reg  [`FP3_DECODED_W-1:0] decoded_q;
    fp3_decode #(.CONFIG(CONFIG)) u_decode (.word_i(fetch_word), .decoded_o(decoded));
    reg                  valid_q;
    reg  [31:0]          word_q;

    always @(posedge clk_i) begin
        if (rst_i || stop || illegal) valid_q <= 1'b0;
        else if (advance)             valid_q <= fetched;
        if (advance) begin
            decoded_q <= decoded;
            pc_q      <= fetch_pc;
            word_q    <= fetch_word;
        end
    end

    `FP3_DECODED_FIELDS
    assign `FP3_DECODED = decoded_q;                      // some fields are for many objects

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
    wire             blocked, taken, in_flight_none, write, write_mul, chain_soon;
    wire [REG_W-1:0] write_d;
    wire [1:0]       a_bypass, b_bypass, c_bypass;

    wire unit_busy = sums && chain_soon;
    wire port_busy = taken || (WRITEBACK_STALL != 0 && write);
    wire issue     = valid_q && legal && !blocked && !unit_busy && !port_busy && !stop;
    assign advance = !valid_q || issue;
    assign illegal = valid_q && !legal;

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
    wire [31:0] sum, product, chain_z;
    wire [4:0]  sum_flags, product_flags;
    wire [31:0] result = write_mul ? product : sum;
    reg  [1:0]  a_bypass_q, b_bypass_q, c_bypass_q;    // a_bypass_q = 3: the constant 1.0
    reg  [1:0]  add_a_q, add_b_q;      // likewise; of add_a_q 3 is a chain's addend
    reg         chain_q, subtract_q;
    reg  [CHOICE_W-1:0] choice_q;

    // One memory per read port: every FPGA's RAM can do one read and one write.
    wire             writes      = write || host_write;
    wire [REG_W-1:0] write_addr  = write ? write_d : host_addr;
    wire [31:0]      write_value = write ? result : host_wdata;
    fp3_ram_forward #(.ADDR_W(REG_W)) u_a (.clk_i(clk_i), .write_i(writes), .write_addr_i(write_addr),
        .write_value_i(write_value),
        .read_addr_i(running_q ? a : host_addr), .read_value_o(a_value));
    fp3_ram_forward #(.ADDR_W(REG_W)) u_b (.clk_i(clk_i), .write_i(writes), .write_addr_i(write_addr),
        .write_value_i(write_value),
        .read_addr_i(b), .read_value_o(b_value));
    fp3_ram_forward #(.ADDR_W(REG_W)) u_c (.clk_i(clk_i), .write_i(writes), .write_addr_i(write_addr),
        .write_value_i(write_value),
        .read_addr_i(c), .read_value_o(c_value));
    assign host_rdata = a_value;

    always @(posedge clk_i) begin
        a_bypass_q <= FUSED != 0 && alone ? 2'b11 : a_bypass;
        b_bypass_q <= b_bypass;
        c_bypass_q <= c_bypass;
        add_a_q    <= chain_soon ? 2'b11 : a_bypass;
        add_b_q    <= chain_soon ? 2'b10 : b_bypass;
        subtract_q <= subtract;
        chain_q    <= !rst_i && issue && chains;
        choice_q   <= choice;
    end

    `FP3_OPERANDS_FIELDS
    assign {operands_choice, operands_subtract, operands_twice, operands_halve} = {choice_q, subtract_q, 2'b00};
    assign operands_x = FUSED != 0 && &a_bypass_q ? BITS_ONE : a_bypass_q[1] ? product : a_bypass_q[0] ? sum : a_value;
    assign operands_y = b_bypass_q[1] ? product : b_bypass_q[0] ? sum : b_value;
    assign operands_z = c_bypass_q[1] ? product : c_bypass_q[0] ? sum : c_value;
    // The adder's, of a chained product, too
    wire [31:0] add_a = add_a_q[1] ? (add_a_q[0] ? chain_z : product) : add_a_q[0] ? sum : a_value;
    wire [31:0] add_b = add_b_q[1] ? product : add_b_q[0] ? sum : b_value;

    generate
        if (FUSED != 0) begin : g_fused
            wire unused_chain = &{chain_q, add_a, add_b};
            assign {chain_soon, chain_z} = 33'd0;
            fp3_solo_fused #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(`FP3_OPERANDS),
                .sum_o({sum_flags, sum}), .product_o({product_flags, product}));
        end else begin : g_separate
            fp3_solo_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .rst_i(rst_i),
                .chain_i(chain_q), .operands_i(`FP3_OPERANDS), .add_a_i(add_a), .add_b_i(add_b),
                .chain_soon_o(chain_soon), .chain_z_o(chain_z),
                .sum_o({sum_flags, sum}), .product_o({product_flags, product}));
        end
    endgenerate

    // A run ends when nothing is left to fetch, to issue or to write ---------------------------
    always @(posedge clk_i)
        if (rst_i)      running_q <= 1'b0;
        else if (start) running_q <= 1'b1;
        else if (fetch_empty && !valid_q && in_flight_none) running_q <= 1'b0;

    // Every running cycle is an issue or exactly one stall ---------------------------------------
    wire waiting = running_q && valid_q && !issue;
    assign event_cycles           = running_q;
    assign event_issued_add       = issue && to_add;
    assign event_issued_mul       = issue && to_mul;
    assign event_issued_chain     = issue && to_chain;
    assign event_retired          = write;
    assign event_stall_fetch      = running_q && !valid_q && !fetch_empty;
    assign event_stall_drain      = (running_q && !valid_q && fetch_empty)
                                 || (waiting && (!legal || stop));
    assign event_stall_dependency = waiting && legal && !stop && blocked;
    assign event_stall_unit       = waiting && legal && !stop && !blocked && unit_busy;
    assign event_stall_writeback  = waiting && legal && !stop && !blocked && !unit_busy;
    assign {event_issued_sleep, event_issued_memory, event_stall_asleep, event_paired} = 4'd0;

    assign issue_valid_o     = issue;
    assign issue_pc_o        = {{16-PROGRAM_W{1'b0}}, pc_q};
    assign issue_word_o      = word_q;
    assign retire_valid_o    = write;
    assign retire_register_o = {{6-REGISTER_W{1'b0}}, write_d[REGISTER_W-1:0]};
    assign retire_value_o    = result;
    assign retire_flags_o    = FLAGS == 0 ? 5'd0 : write_mul ? product_flags : sum_flags;
    wire unused = &{write_d[REGISTER_W], address};

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i && running_q && (host_write || program_write)) begin
            $display("%m: the host writes while a program runs"); $stop;
        end else if (!rst_i && issue && sums && chain_soon) begin
            $display("%m: a sum meets a chained product in the adder"); $stop;
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
