// SPDX-License-Identifier: Apache-2.0
// fp3_fp_rint: a number rounded to an integral value.
//
// Purpose   IEEE 754's roundToIntegral: to nearest, ties to even, or (NEAREST = 0) toward zero. The
//           sign stays, also of a zero. No flag: the adder behind fp_value raises the flag of a
//           NaN.
// Latency   1, or 2 with CUT: a register behind the comparisons of the exponent, and one behind
//           whether to round up.
// Hazard    An infinity and a NaN pass as they are.
//
//     a_i 40200000 (2.5)  ->  z_o 40000000 (2);   a_i BF400000 (-0.75)  ->  z_o BF800000 (-1)
`default_nettype none
module fp3_fp_rint #(
    parameter CUT     = 0,
    parameter NEAREST = 1
) (
    input  wire        clk_i,
    input  wire [31:0] a_i,
    output wire [31:0] z_o
);
`include "gen/isa.vh"
    localparam [7:0] WHOLE = 8'd150;   // from this exponent on there is no fraction
    localparam [7:0] ONE   = 8'd127;   // from here on there is an integer part; half of it below
    wire [7:0] e = a_i[30:23];

    // Bit i of the significand is behind the point.
    reg  [31:0] a_q;
    reg  [22:0] behind_q;
    reg         half_q, small_q;       // at least 1/2 and below 1; below 1
    integer     i;
    always @(posedge clk_i) begin
        a_q     <= a_i;
        half_q  <= e == ONE - 8'd1;
        small_q <= e < ONE;
        for (i = 0; i < 23; i = i + 1) behind_q[i] <= e < WHOLE - i[7:0];
    end

    // What is added: 1 in the last place before the point, if the bits behind it say so.
    wire [22:0] first = behind_q & ~{1'b0, behind_q[22:1]};          // the first behind it
    wire        guard = half_q || (!small_q && |(a_q[22:0] & first));
    wire        rest  = |(a_q[22:0] & (half_q ? behind_q : {1'b0, behind_q[22:1]}));
    wire        odd   = !half_q && |(a_q[23:1] & first);
    wire        up    = NEAREST != 0 && guard && (rest || odd);

    wire [31:0] kept, kept_c;
    wire [22:0] first_c;
    wire        up_c, small_c;
    assign kept = {a_q[31], small_q ? 8'd0 : a_q[30:23], a_q[22:0] & ~behind_q};
    fp3_cut #(.W(57), .ON(CUT)) u_cut (.clk_i(clk_i), .d_i({kept, first, up, small_q}),
        .q_o({kept_c, first_c, up_c, small_c}));

    // A carry out of the fraction is one of the exponent, as it must be; 1 follows 0 at once.
    wire [30:0] larger = kept_c[30:0] + (up_c ? {7'd0, first_c, 1'b0} : 31'd0);
    assign z_o = {kept_c[31], small_c ? BITS_ONE[30:0] & {31{up_c}} : larger};
endmodule
`default_nettype wire
