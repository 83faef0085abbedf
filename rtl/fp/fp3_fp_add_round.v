// SPDX-License-Identifier: Apache-2.0
// fp3_fp_add_round: the end of fp_add: normalises by 0, 1 or 2 places, rounds, and packs.
//
// Purpose   Chooses between these places and the near path in one four-way choice, so that
//           no leading zeros are counted between the addition and the rounding.
// Latency   As many cycles as CUTS has ones. The near path enters one cut later than the sum, at
//           the choice.
//
//     sum 01.10..01 10, e 127  ->  1.10..10, exponent 127      (a tie goes to even)
`default_nettype none
module fp3_fp_add_round #(
    parameter       EXP       = 8,
    parameter       FRAC      = 23,
    parameter       SUBNORMAL = 1,
    parameter       NEAREST   = 1,
    parameter       FINITE    = 0,
    parameter [1:0] CUTS      = 0       // after: pick, choose
) (
    input  wire              clk_i,
    input  wire [FRAC+3:0]   sum_i,     // carry, hidden bit, fraction, guard, round
    input  wire              sticky_i,
    input  wire              below_i,   // the sum is too great by a part of its last place
    input  wire [EXP-1:0]    e_i,
    input  wire              close_i,   // the near path is right if the sum's top bits are 0
    input  wire              made_i,    // zero, infinity or NaN: the sum is the result
    input  wire              sign_i,
    input  wire              invalid_i,
    input  wire [FRAC-1:0]   near_frac_i,
    input  wire [EXP-1:0]    near_e_i,
    input  wire              near_hidden_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o
);
    localparam S = FRAC + 4;

    // Pick. An overflow before rounding has its value from the near path as well.
    localparam [0:0] TOP = FINITE != 0;                  // the last bit of the largest exponent
    wire       full  = &e_i[EXP-1:1] && e_i[0] == TOP;
    wire       full1 = &e_i[EXP-1:2] && e_i[1] == TOP && e_i[0] != TOP;
    wire       least = ~|e_i[EXP-1:1] && e_i[0];        // no further: the result is subnormal
    wire       over  = sum_i[S-1] && full;
    wire       last  = sum_i[S-1] ? full1 : full && sum_i[S-2];
    wire [1:0] pick  = sum_i[S-1] ? {2{full}} : made_i ? 2'd0
                     : {!sum_i[S-2] && !least, sum_i[S-2] || least || close_i};

    wire [S-1:0]   s;
    wire [EXP-1:0] e;
    wire [1:0]     pick0;
    wire over0, last0, made, sticky, below, sign0, invalid0;
    fp3_cut #(.W(S + EXP + 9), .ON(CUTS[0])) u_pick (.clk_i(clk_i),
        .d_i({sum_i, e_i, pick, over, last, made_i, sticky_i, below_i, sign_i, invalid_i}),
        .q_o({s, e, pick0, over0, last0, made, sticky, below, sign0, invalid0}));

    reg [FRAC-1:0] f;
    reg [EXP-1:0]  field;
    reg            hidden, rest, up;
    always @* case (pick0)
        2'd0: begin
            {field, f, hidden} = {e, s[3 +: FRAC], s[S-1] || made};
            rest = |s[2:0];
            up   = s[2] && (s[3] || s[1] || s[0] || sticky);
        end
        2'd1: begin // the hidden bit makes up for the place; without it the field is 0, not 1
            {field, f, hidden} = {e[EXP-1:1], e[0] && s[S-2], s[2 +: FRAC], s[S-2]};
            rest = |s[1:0];
            up   = s[1] && (below ? s[0] : s[2] || s[0] || sticky);
        end
        2'd2: begin
            {field, f, hidden} = {e, s[1 +: FRAC], 1'b1};
            rest = s[0];
            up   = s[0] && !below && (s[1] || sticky);
        end
        2'd3: begin
            {field, f, hidden} = {near_e_i, near_frac_i, near_hidden_i || over0};
            rest = 1'b0;
            up   = 1'b0;
        end
    endcase
    wire tiny = SUBNORMAL == 0 && !hidden;

    wire [FRAC-1:0] frac1;
    wire [EXP-1:0]  field1;
    wire inc, dec, up1, sign1, invalid1, over1, last1, tiny1, inexact1;
    fp3_cut #(.W(FRAC + EXP + 9), .ON(CUTS[1])) u_choose (.clk_i(clk_i),
        .d_i({f & {FRAC{!tiny}}, field, pick0 == 2'd0 && s[S-1], pick0 == 2'd2, NEAREST != 0 && up,
              sign0 && !(FINITE != 0 && tiny), invalid0, over0, last0, tiny, over0 || rest || sticky || tiny}),
        .q_o({frac1, field1, inc, dec, up1, sign1, invalid1, over1, last1, tiny1, inexact1}));

    // Round. A carry out of the fraction counts into the exponent.
    wire rounded_over = last1 && up1 && &frac1;
    assign z_o     = {sign1, {field1, frac1} + {{EXP-1{dec}}, dec || inc, {FRAC-1{1'b0}}, up1}};
    assign flags_o = {invalid1, 1'b0, over1 || rounded_over, tiny1, inexact1 || rounded_over};
endmodule
`default_nettype wire
