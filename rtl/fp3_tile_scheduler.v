// SPDX-License-Identifier: Apache-2.0
// fp3_tile_scheduler: one scheduler with its lanes, seen by the host. Everything but the
// arithmetic.
//
// Purpose   The parts of one program: the host port, the sequencer and the lanes that follow it,
//           each group of four a cycle after the group before.
//
//           host_port ─► sequencer ─► group ─► group ─► ...
//                            ▲                           │
//                            └──────── reports ◄─────────┘
//
// Latency   See sequencer, lane and host_port. Operands leave and results arrive as lane says;
//           adds_o and muls_o ask for a unit two cycles before the first lane says the instruction,
//           five before its operands. A request that is for a word of a store reaches it three
//           cycles later, as an instruction that leaves the sequencer then.
// Hazard    Operands without a grant do not reach the arithmetic. The host accesses lanes, and
//           writes the program, only between runs; with OVERLAP it reaches the part of the stores
//           that a run leaves out, when loads_o or stores_o is low.
`default_nettype none
`include "host/answer.vh"
`include "gen/settings.vh"
`include "gen/events.vh"
`include "lane/bundles.vh"
`include "sequence/issued.vh"
module fp3_tile_scheduler #(
`include "config/config.vh"
) (
    input  wire                clk_i,
    input  wire                rst_i,
    // Host port
    input  wire                req_valid_i,
    input  wire                req_write_i,
    input  wire [23:0]         req_addr_i,
    input  wire [31:0]         req_wdata_i,
    output wire [`FP3_ANSWER_W-1:0] answer_o,
    output wire                irq_o,
    // The units
    output wire                running_o,
    output wire                adds_o,
    output wire                muls_o,
    output wire                sweep_end_o,
    input  wire                grant_i,
    // With OVERLAP: an instruction will have this port of the stores, so no access of the host three
    // cycles later
    output wire                loads_o,
    output wire                stores_o,
    // Arithmetic and trace, STREAMS parts for each lane
    output wire [`FP3_OPERANDS_W*STREAMS*LANES-1:0] operands_o,
    input  wire [`FP3_RESULT_W*STREAMS*LANES-1:0]   result_i,
    output wire [`FP3_WRITTEN_W*STREAMS*LANES-1:0]  written_o,
    output wire [`FP3_ISSUED_W*STREAMS-1:0] issued_o           // trace
);
`include "host/lane_host.vh"

    // The host -------------------------------------------------------------------------------
    wire                 start, stop, running, illegal, half, overfull, no_room, raised, program_write, access, host_write;
    wire [31:0]          host_wdata, word;
    wire [`FP3_SETTINGS_W-1:0] settings;
    wire [`FP3_EVENTS_W-1:0]   events;
    wire [PROGRAM_W-1:0] illegal_pc, program_addr;
    wire [2:0]           space;
    wire [19:0]          address;
    wire [4:0]           flags;
    wire [1:0]           part;
    fp3_host_port #(.CONFIG(CONFIG)) u_host_port (
        .clk_i(clk_i), .rst_i(rst_i),
        .req_valid_i(req_valid_i), .req_write_i(req_write_i),
        .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
        .answer_o(answer_o), .irq_o(irq_o),
        .start_o(start), .stop_o(stop), .settings_o(settings), .part_o(part),
        .running_i(running), .illegal_i(illegal), .illegal_pc_i(illegal_pc), .half_i(half), .overfull_i(overfull),
        .no_room_i(no_room), .raised_i(raised), .flags_i(flags), .events_i(events),
        .program_write_o(program_write), .program_addr_o(program_addr),
        .access_o(access), .write_o(host_write), .space_o(space), .addr_o(address),
        .wdata_o(host_wdata), .rdata_i(word));

    // Where records have 16 bits a word for one is rounded before it goes to its lane, unless it is
    // the word that is kept whole. Every access is delayed by the same time.
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS = settings;
    wire        late_access, late_write, late_whole;
    wire [2:0]  late_space;
    wire [19:0] late_address;
    wire [31:0] late_wdata;
    generate
        if (STORAGE != 0) begin : g_narrowed
            wire [15:0] narrow_word;
            wire [31:0] whole_word;
            wire        over;
            fp3_narrow #(.STORAGE(STORAGE)) u_narrow (.clk_i(clk_i), .word_i(host_wdata), .draws_i(1'b0),
                .random_i(16'd0), .narrow_o(narrow_word), .over_o(over));
            fp3_delay #(.W(1), .N(TIMING_NARROW)) u_access (.clk_i(clk_i), .rst_i(rst_i), .d_i(access),
                .q_o(late_access));
            fp3_delay #(.W(56), .N(TIMING_NARROW)) u_what (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({host_write, space, address, host_wdata}),
                .q_o({late_write, late_space, late_address, whole_word}));
            wire [5:0] of_record = late_address[5:0] & ~(6'h38 << setting_record);
            assign late_whole = WHOLE != 0 && late_space == HOST_OBJECT && {1'b0, of_record} == setting_whole;
            assign late_wdata = late_space == HOST_OBJECT && !late_whole ? {16'd0, narrow_word} : whole_word;
            wire unused_over = over;
        end else begin : g_not_narrowed
            assign {late_access, late_write, late_space, late_address, late_wdata} = {access, host_write, space, address, host_wdata};
            assign late_whole = 1'b0;
        end
    endgenerate

    // Constants are in all lanes, and only there for reading; this copy is the host's. A host that
    // reads a constant makes no other request until it has the constant.
    wire [31:0] constant, lanes_answer;
    reg  [31:0] word_q;
    fp3_ram_registered #(.ADDR_W(REGISTER_W)) u_constants (.clk_i(clk_i),
        .write_i(access && host_write && space == HOST_CONSTANT && !rst_i),
        .write_addr_i(address[REGISTER_W-1:0]), .write_value_i(host_wdata),
        .read_i(1'b1), .read_addr_i(address[REGISTER_W-1:0]), .read_value_o(constant));
    always @(posedge clk_i) word_q <= space == HOST_CONSTANT ? constant : lanes_answer;
    assign word = word_q;

    `FP3_ACCESS_FIELDS
    wire                      by_lane = late_space == HOST_AWAKE || late_space == HOST_WAKE;
    wire [LANE_W+STORE_W-1:0] spot    = late_address[LANE_W+STORE_W-1:0];
    assign access_valid   = late_access && !(EXCHANGE != 0 && late_space == HOST_COPIES);
    assign access_write   = late_write;
    assign access_space   = late_space;
    assign access_whole   = late_whole;
    assign access_lane    = by_lane ? late_address[LANE_W-1:0] : LANES > 1 ? spot[STORE_W +: LANE_W] : {LANE_W{1'b0}};
    assign access_address = late_address[STORE_W-1:0];

    // The sequencer and its lanes, in groups: group g has its inputs at g, its outputs at g + 1
    // ------------
    localparam ISSUES_W = `FP3_LANE_ISSUE_W, RETIRES_W = `FP3_LANE_RETIRE_W, REACHES_W = `FP3_REACH_W;
    wire [GROUPS:0]                 resets;
    wire [REACHES_W*(GROUPS+1)-1:0] reaches;
    wire [ISSUES_W*(GROUPS+1)-1:0]  issues;
    wire [RETIRES_W*(GROUPS+1)-1:0] retires;
    wire [`FP3_ACCESS_W*(GROUPS+1)-1:0] accesses;
    wire [32*(GROUPS+1)-1:0]        data;
    wire [DRAW_W*(GROUPS+1)-1:0]    draws;
    wire [`FP3_REPORT_W*(GROUPS+1)-1:0] reports;
    wire [31:0]                    step_number;
    wire                           copy, abort, copied, settled, held;
    wire [REACHES_W-1:0]           reach;
    wire [DRAW_W-1:0]              draw;
    assign running_o = running;
    fp3_sequencer #(.CONFIG(CONFIG)) u_sequencer (
        .clk_i(clk_i), .rst_i(rst_i),
        .start_i(start), .stop_i(stop), .settings_i(settings),
        .running_o(running), .illegal_o(illegal), .illegal_pc_o(illegal_pc), .half_o(half),
        .settled_o(settled), .held_o(held), .copy_o(copy), .abort_o(abort), .copied_i(copied),
        .program_write_i(program_write), .program_addr_i(program_addr), .program_word_i(host_wdata),
        .adds_o(adds_o), .muls_o(muls_o), .sweep_end_o(sweep_end_o), .grant_i(grant_i),
        .reach_o(reach), .issue_o(issues[0 +: ISSUES_W]), .retire_o(retires[0 +: RETIRES_W]), .step_o(step_number),
        .draw_o(draw),
        .report_i(reports[`FP3_REPORT_W*GROUPS +: `FP3_REPORT_W]), .events_o(events), .issued_o(issued_o));
    assign resets[0]                = rst_i;

    // Copies from lane to lane use the paths of the instructions' store reads and of the host's
    // writes.
    generate
        if (EXCHANGE != 0) begin : g_exchange
            wire                 copying;
            wire [REACHES_W-1:0] copy_reach;
            wire [`FP3_ACCESS_W-1:0] copy_access;
            fp3_exchange #(.CONFIG(CONFIG)) u_exchange (.clk_i(clk_i), .rst_i(rst_i),
                .write_i(access && host_write && space == HOST_COPIES), .write_addr_i(address[STORE_W-1:0]),
                .write_value_i(host_wdata),
                .settings_i(settings), .half_i(half), .copy_i(copy), .abort_i(abort), .copied_o(copied),
                .busy_o(copying), .reach_o(copy_reach), .access_o(copy_access));
            assign reaches[0 +: REACHES_W]  = copying ? copy_reach : reach;
            assign accesses[0 +: `FP3_ACCESS_W] = copying ? copy_access : `FP3_ACCESS;
            assign data[31:0]               = copying ? lanes_answer : running ? step_number : late_wdata;
        end else begin : g_no_exchange
            assign copied                   = 1'b0;
            assign reaches[0 +: REACHES_W]  = reach;
            assign accesses[0 +: `FP3_ACCESS_W] = `FP3_ACCESS;
            assign data[31:0]               = running && OVERLAP == 0 ? step_number : late_wdata;     // no lane needs the step there
            wire unused_copy = &{copy, abort};
        end
    endgenerate

    generate
        if (OVERLAP != 0) begin : g_part
            `FP3_REACH_FIELDS
            `FP3_ISSUE_FIELDS
            assign `FP3_REACH = reach;
            assign `FP3_ISSUE = issues[0 +: ISSUES_W];
            assign draws[0 +: DRAW_W]  = part;
            assign {loads_o, stores_o} = {reach_load, issue_st || issue_keep};
            wire unused_draw = &{draw, step_number};
        end else begin : g_whole
            assign draws[0 +: DRAW_W]  = draw;
            assign {loads_o, stores_o} = 2'b00;
            wire unused_part = &part;
        end
    endgenerate

    // In front of the first lane there is no object, and none awake.
    `FP3_REPORT_FIELDS
    assign reports[0 +: `FP3_REPORT_W] = `FP3_REPORT_NONE;
    assign `FP3_REPORT                 = reports[`FP3_REPORT_W*GROUPS +: `FP3_REPORT_W];
    generate
        if (KEEP != 0) begin : g_of_round
            // Those of a round count when it is over, unless it ended with `hold`: it is no part of
            // what the program computes.
            reg  [4:0] of_round_q;
            wire [4:0] of_round = of_round_q | report_flags;
            always @(posedge clk_i) of_round_q <= rst_i || settled ? 5'd0 : of_round;
            assign flags = of_round & {5{settled && !held}};
        end else begin : g_at_once
            assign flags = report_flags;
            wire unused_held = &{settled, held};
        end
    endgenerate
    assign overfull                = SLEEP != 0 && report_count[ROW_W] && report_count[0];       // the only count beyond
    assign {no_room, raised}       = {report_no_room, report_raised};
    assign lanes_answer            = report_answer;

    wire [`FP3_WRITTEN_W*STREAMS*LANES-1:0] written;
    assign written_o = written & {`FP3_WRITTEN_W*STREAMS*LANES{!rst_i}};     // nothing of lanes that the reset has not yet reached
    genvar g;
    generate
        for (g = 0; g < GROUPS; g = g + 1) begin : g_group
            localparam F = GROUP * g;                             // its first lane
            localparam N = LANES - F < GROUP ? LANES - F : GROUP;
            fp3_lane_group #(.CONFIG(CONFIG), .N(N)) u_group (
                .clk_i(clk_i), .first_i(F[LANE_W-1:0]), .rst_i(resets[g]), .rst_o(resets[g+1]),
                .reach_i(reaches[REACHES_W*g +: REACHES_W]), .reach_o(reaches[REACHES_W*(g+1) +: REACHES_W]),
                .issue_i(issues[ISSUES_W*g +: ISSUES_W]), .issue_o(issues[ISSUES_W*(g+1) +: ISSUES_W]),
                .retire_i(retires[RETIRES_W*g +: RETIRES_W]), .retire_o(retires[RETIRES_W*(g+1) +: RETIRES_W]),
                .access_i(accesses[`FP3_ACCESS_W*g +: `FP3_ACCESS_W]),
                .access_o(accesses[`FP3_ACCESS_W*(g+1) +: `FP3_ACCESS_W]),
                .data_i(data[32*g +: 32]), .data_o(data[32*(g+1) +: 32]),
                .draw_i(draws[DRAW_W*g +: DRAW_W]), .draw_o(draws[DRAW_W*(g+1) +: DRAW_W]),
                .report_i(reports[`FP3_REPORT_W*g +: `FP3_REPORT_W]),
                .report_o(reports[`FP3_REPORT_W*(g+1) +: `FP3_REPORT_W]),
                .operands_o(operands_o[`FP3_OPERANDS_W*STREAMS*F +: `FP3_OPERANDS_W*STREAMS*N]),
                .result_i(result_i[`FP3_RESULT_W*STREAMS*F +: `FP3_RESULT_W*STREAMS*N]),
                .written_o(written[`FP3_WRITTEN_W*STREAMS*F +: `FP3_WRITTEN_W*STREAMS*N]));
        end
    endgenerate

    // The last group has no next one; sequencer hears the rest of its report.
    wire unused = &{resets[GROUPS], reaches[REACHES_W*GROUPS +: REACHES_W], issues[ISSUES_W*GROUPS +: ISSUES_W], retires[RETIRES_W*GROUPS +: RETIRES_W],
                    accesses[`FP3_ACCESS_W*GROUPS +: `FP3_ACCESS_W], data[32*GROUPS +: 32], draws[DRAW_W*GROUPS +: DRAW_W], late_address, spot};

`ifdef FP3_CHECK
    // An instruction granted AHEAD + TO_END + 1 cycles ago ends in the first lane, ENDED cycles
    // before its result.
    generate
        if (DUAL == 0) begin : g_granted
            wire granted;
            `FP3_RETIRE_FIELDS
            assign `FP3_RETIRE = retires[0 +: `FP3_RETIRE_W];
            fp3_delay #(.W(1), .N(AHEAD+TO_END+1)) u_granted (.clk_i(clk_i), .rst_i(rst_i),
                .d_i((adds_o || muls_o) && grant_i), .q_o(granted));
            always @(posedge clk_i)
                if (!rst_i && granted != (retire_valid && retire_arithmetic)) begin
                    $display("%m: arithmetic that was not granted a unit %0d cycles ago, or the reverse", AHEAD + TO_END + 1); $stop;
                end
        end
    endgenerate
    always @(posedge clk_i)
        if (!rst_i) begin
            if (((access && !(OVERLAP != 0 && space == HOST_OBJECT)) || program_write) && running) begin
                $display("%m: an access of the host within a run"); $stop;
            end
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
