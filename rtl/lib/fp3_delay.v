// SPDX-License-Identifier: Apache-2.0
// fp3_delay: N registers in a row.
//
// Purpose   Keeps signals beside a pipeline in step with the pipeline.
// Latency   N cycles; 0 is a wire. rst_i clears every register: it is 0 for data, which needs no
//           reset.
//
//     delay #(.W(5), .N(3)) u_flags (.clk_i(clk_i), .rst_i(1'b0), .d_i(flags), .q_o(flags_3));
`default_nettype none
module fp3_delay #(
    parameter W = 1,                   // width
    parameter N = 1                    // cycles
) (
    input  wire         clk_i,
    input  wire         rst_i,
    input  wire [W-1:0] d_i,
    output wire [W-1:0] q_o
);
    generate
        if (N == 0) begin : g_wire
            // A wire needs neither clock nor reset.
            wire unused = clk_i & rst_i;
            assign q_o = d_i;
        end else if (N == 1) begin : g_one
            reg [W-1:0] d_q;
            always @(posedge clk_i)
                if (rst_i) d_q <= {W{1'b0}};
                else       d_q <= d_i;
            assign q_o = d_q;
        end else begin : g_many
            reg [N*W-1:0] d_q;
            always @(posedge clk_i)
                if (rst_i) d_q <= {N*W{1'b0}};
                else       d_q <= {d_q[(N-1)*W-1:0], d_i};
            assign q_o = d_q[N*W-1 -: W];
        end
    endgenerate
endmodule
`default_nettype wire
