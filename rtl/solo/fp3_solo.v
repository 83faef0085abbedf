// SPDX-License-Identifier: Apache-2.0
// fp3_solo: one scheduler with busy flags and its arithmetic unit, for one object.
//
// Purpose   The paper's machine, and the shortest time for a single object: results are used as
//           soon as they exist, whatever their unit's latency.
//
//           host port ──► scheduler ──► arithmetic unit
//                    ◄──     │     ◄────────┘
//
//           Trace ports (issue_*, retire_*) are for simulation.
// Latency   See solo_scheduler (a run), host_port (an access).
`default_nettype none
`include "host/answer.vh"
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
`include "gen/registers.vh"
`include "host/lane_host.vh"
    wire                            start, stop, running, illegal;
    wire [`FP3_SETTINGS_W-1:0]          settings;
    wire [PROGRAM_W-1:0]            issue_pc, program_addr;
    wire                            program_write, access, host_write;
    wire [2:0]                      space;
    wire [19:0]                     address;
    wire [31:0]                     host_wdata, host_rdata;
    wire [REGISTER_W-1:0]           retire_register;
    wire                            chain, chain_soon;
    wire [`FP3_OPERANDS_W-1:0]          operands;
    wire [`FP3_RESULT_W-1:0]            sum, product;
    wire [31:0]                     add_a, add_b, chain_z;
    wire [4:0]                      retire_flags;

    `FP3_EVENTS_FIELDS
    fp3_host_port #(.CONFIG(CONFIG)) u_host_port (
        .clk_i(clk_i), .rst_i(rst_i),
        .req_valid_i(req_valid_i), .req_write_i(req_write_i),
        .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
        .answer_o(answer_o), .irq_o(irq_o),
        .start_o(start), .stop_o(stop), .settings_o(settings),
        .running_i(running), .illegal_i(illegal), .illegal_pc_i(issue_pc), .half_i(1'b0), .overfull_i(1'b0),
        .flags_i(retire_flags_o & {5{retire_valid_o}}), .events_i(`FP3_EVENTS),
        .program_write_o(program_write), .program_addr_o(program_addr),
        .access_o(access), .write_o(host_write), .space_o(space), .addr_o(address),
        .wdata_o(host_wdata), .rdata_i(host_rdata));

    // In reset a request may still be anything: its registers have no reset.
    fp3_solo_scheduler #(.CONFIG(CONFIG)) u_scheduler (
        .clk_i(clk_i), .rst_i(rst_i),
        .start_i(start), .stop_i(stop), .settings_i(settings), .running_o(running), .illegal_o(illegal),
        .host_program_i(program_write), .host_write_i(access && host_write && !rst_i),
        .host_program_addr_i(program_addr),
        .host_addr_i({space == HOST_CONSTANT, address[REGISTER_W-1:0]}), .host_wdata_i(host_wdata),
        .host_rdata_o(host_rdata),
        .chain_o(chain), .operands_o(operands), .add_a_o(add_a), .add_b_o(add_b),
        .chain_soon_i(chain_soon), .chain_z_i(chain_z), .sum_i(sum), .product_i(product),
        .issue_o(issue_valid_o), .issue_add_o(event_issued_add), .issue_mul_o(event_issued_mul),
        .issue_chain_o(event_issued_chain), .issue_pc_o(issue_pc), .issue_word_o(issue_word_o),
        .stall_fetch_o(event_stall_fetch), .stall_dependency_o(event_stall_dependency),
        .stall_unit_o(event_stall_unit), .stall_writeback_o(event_stall_writeback), .stall_drain_o(event_stall_drain),
        .retire_o(retire_valid_o), .retire_register_o(retire_register), .retire_value_o(retire_value_o),
        .retire_flags_o(retire_flags));
    assign retire_flags_o = FLAGS != 0 ? retire_flags : 5'd0;

    generate
        if (FUSED != 0) begin : g_fused
            wire unused_chain = &{chain, add_a, add_b};
            assign {chain_soon, chain_z} = 33'd0;
            fp3_solo_fused #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands), .sum_o(sum), .product_o(product));
        end else begin : g_separate
            fp3_solo_arith #(.CONFIG(CONFIG)) u_arith (
                .clk_i(clk_i), .rst_i(rst_i),
                .chain_i(chain), .operands_i(operands), .add_a_i(add_a), .add_b_i(add_b),
                .chain_soon_o(chain_soon), .chain_z_o(chain_z), .sum_o(sum), .product_o(product));
        end
    endgenerate

    assign event_cycles  = running;
    assign event_retired = retire_valid_o;
    assign {event_issued_sleep, event_issued_memory, event_stall_asleep, event_paired} = 4'd0;

    assign issue_pc_o        = {{16-PROGRAM_W{1'b0}}, issue_pc};
    assign retire_register_o = {{6-REGISTER_W{1'b0}}, retire_register};
    wire unused = |address;
endmodule
`default_nettype wire
`include "config/undefine.vh"
