// SPDX-License-Identifier: Apache-2.0
// fp3_cut: a pipeline register that a parameter puts in or leaves out.
//
// Purpose   Every place where a floating-point core may be cut is one of these, so that a
//           mask chooses the depth and the logic between the cuts is written once.
// Latency   With ON 1 cycle, without 0: a wire. There is no reset and no enable: only data flows
//           through, and its valid bit travels beside it.
//
//     cut #(.W(32), .ON(CUTS[3])) u_align (.clk_i(clk_i), .d_i(sum), .q_o(sum_c));
`default_nettype none
module fp3_cut #(
    parameter W  = 1,                  // width
    parameter ON = 0                   // 1: a register, 0: a wire
) (
    input  wire         clk_i,
    input  wire [W-1:0] d_i,
    output wire [W-1:0] q_o
);
    generate
        if (ON) begin : g_register
            reg [W-1:0] d_q;
            always @(posedge clk_i) d_q <= d_i;
            assign q_o = d_q;
        end else begin : g_wire
            // A wire needs no clock.
            wire unused = clk_i;
            assign q_o = d_i;
        end
    endgenerate
endmodule
`default_nettype wire
