// SPDX-License-Identifier: Apache-2.0
// fp3_turns: requests of two to one hub: of the host, by axi_lite, and of a transfer.
//
// Purpose   Answers have no tags and cannot be delayed, so only one of the two has requests under
//           way: the other one gets its turn when all are answered. The host does not notice but for
//           the time. A turn ends when its owner has nothing to ask for, or has made TURN requests,
//           and the other one wants it.
// Latency   0 from a request to the hub, 0 from its answer. A change of turns takes the time of the
//           requests under way and REST cycles.
// Promise   Each request that is taken goes to the hub once, and its answer to who asked. Both get
//           their turn while they want it. A request of the transfer that does not stream is alone,
//           as axi_lite says it: nothing else is under way, and none follows within REST cycles of
//           its answer.
// Hazard    Of the host, axi_lite looks after that. A write and a read may be answered at once. At most
//           2^OPEN_W - 1 requests are under way.
`default_nettype none
module fp3_turns #(
    parameter W    = 32,               // bits of a request but for its two
    parameter TURN = 64,               // a power of two
    parameter REST = 4,                // cycles, fewer than 8
    parameter OPEN_W = 6               // bits of the number of requests under way
) (
    input  wire              clk_i,
    input  wire              rst_i,
    // The host
    input  wire              host_valid_i,
    output wire              host_ready_o,
    input  wire              host_write_i,
    input  wire [W-1:0]      host_what_i,
    // The transfer
    input  wire              move_valid_i,
    output wire              move_ready_o,
    input  wire              move_streams_i,
    input  wire              move_write_i,
    input  wire [W-1:0]      move_what_i,
    output wire              moves_o,            // answers are the transfer's
    output wire [OPEN_W-1:0] open_o,             // requests under way
    // The hub
    output wire              req_valid_o,
    input  wire              req_ready_i,
    output wire              req_write_o,
    output wire [W-1:0]      req_what_o,
    input  wire              wrote_i,            // a write is answered
    input  wire              read_i              // a read is answered
);
    localparam TURN_W = $clog2(TURN);

    reg               moves_q, alone_q;
    reg               wants_q;         // the other one asked in the cycle before
    reg  [TURN_W:0]   made_q;          // requests in this turn, up to TURN
    reg  [OPEN_W-1:0] open_q;
    reg  [2:0]        rest_q;
    wire              still = open_q == {OPEN_W{1'b0}} && rest_q == 3'd0;
    wire              owner = moves_q ? move_valid_i : host_valid_i;
    wire              other = moves_q ? host_valid_i : move_valid_i;
    wire              spent = made_q[TURN_W] && wants_q;
    wire              host_may = host_valid_i && !moves_q && !spent;
    wire              move_may = move_valid_i && moves_q && !spent && (move_streams_i ? !alone_q : still);
    wire              goes  = (host_may || move_may) && req_ready_i;
    wire              turns = other && still && (spent || !owner);
    always @(posedge clk_i)
        if (rst_i) begin
            {moves_q, alone_q} <= 2'd0;
            made_q             <= {TURN_W+1{1'b0}};
            open_q             <= {OPEN_W{1'b0}};
            rest_q             <= 3'd0;
        end else begin
            if (turns) moves_q <= !moves_q;
            wants_q <= other;
            alone_q <= (goes && moves_q && !move_streams_i) || (alone_q && !still);
            if (turns)                         made_q <= {TURN_W+1{1'b0}};
            else if (goes && !made_q[TURN_W])  made_q <= made_q + 1'b1;
            open_q  <= open_q + {{OPEN_W-1{1'b0}}, goes} - {{OPEN_W-1{1'b0}}, wrote_i} - {{OPEN_W-1{1'b0}}, read_i};
            if (wrote_i || read_i)             rest_q <= REST[2:0];
            else if (rest_q != 3'd0)           rest_q <= rest_q - 3'd1;
        end
    assign req_valid_o  = host_may || move_may;
    assign req_write_o  = moves_q ? move_write_i : host_write_i;
    assign req_what_o   = moves_q ? move_what_i : host_what_i;
    assign host_ready_o = host_may && req_ready_i;
    assign move_ready_o = move_may && req_ready_i;
    assign moves_o      = moves_q;
    assign open_o       = open_q;
endmodule
`default_nettype wire
