// SPDX-License-Identifier: Apache-2.0
// fp3_responses: holds the responses to reads or to writes until the master takes them.
//
// Purpose   Answers cannot be delayed, but the master may delay responses. So each request reserves
//           a place here before it is sent.
// Latency   A response stands in the cycle after answered_i.
// Promise   One response for each request, in the order of answered_i. It stays until it is taken.
// Hazard    go_i needs room_o; each go_i has one answered_i, in its cycle or later. The last place
//           but one taken, the last one goes only to a request in the next cycle: room_o is a
//           register.
//
//     cycle        0     1    ..    n    n+1   n+2
//     go_i         1     0
//     answered_i   0     0          1     0
//     idle_o       1     0          0     1             no answer is due
//     valid_o      0     0          0     1     0       ready_i = 1
`default_nettype none
module fp3_responses #(
    parameter W       = 1,             // width
    parameter DEPTH_W = 1              // 2^DEPTH_W places, at least 2
) (
    input  wire         clk_i,
    input  wire         rst_i,
    output wire         room_o,
    output wire         idle_o,
    input  wire         go_i,
    input  wire         answered_i,
    input  wire [W-1:0] value_i,
    output wire         valid_o,
    input  wire         ready_i,
    output wire [W-1:0] value_o
);
    localparam [DEPTH_W:0] ONE = 1;

    // Places in order: kept up to gone, filled up to filled, free again up to taken.
    reg  [DEPTH_W:0] gone_q, filled_q, taken_q;
    reg              room_q;
    reg  [W-1:0]     value_q [0:(1<<DEPTH_W)-1];
    wire [DEPTH_W:0] kept = gone_q - taken_q;
    wire             take = valid_o && ready_i;
    always @(posedge clk_i) begin
        if (rst_i) begin
            {gone_q, filled_q, taken_q} <= {3*(DEPTH_W+1){1'b0}};
            room_q                      <= 1'b0;
        end else begin
            if (go_i)       gone_q   <= gone_q + ONE;
            if (answered_i) filled_q <= filled_q + ONE;
            if (take)       taken_q  <= taken_q + ONE;
            room_q <= !kept[DEPTH_W] && !(&kept[DEPTH_W-1:0]);
        end
        if (answered_i) value_q[filled_q[DEPTH_W-1:0]] <= value_i;
    end
    assign room_o  = room_q;
    assign idle_o  = gone_q == filled_q;
    assign valid_o = filled_q != taken_q;
    assign value_o = value_q[taken_q[DEPTH_W-1:0]];

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i && ((go_i && kept[DEPTH_W]) || (answered_i && idle_o && !go_i))) begin
            $display("%m: %0d of %0d places are kept: a request without room, or an answer without a request", kept, 1 << DEPTH_W); $stop;
        end
`endif
`ifdef FORMAL
    // tests/formal/axi_lite_spec.v: its induction looks at all places.
    reg [W*(1<<DEPTH_W)-1:0] values;
    integer i;
    always @*
        for (i = 0; i < 1 << DEPTH_W; i = i + 1) values[W*i +: W] = value_q[i];
`endif
endmodule
`default_nettype wire
