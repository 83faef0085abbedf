// add_cases: the case that a pair of addends falls in.
`default_nettype none
module add_cases #(
    parameter EXP = 8, FRAC = 23
) (
    input  wire [EXP+FRAC:0] a_i, b_i,
    input  wire              sub_i,
    output wire [EXP-1:0]    distance_o,   // between the exponents
    output wire              far_o,        // the smaller addend is only a sticky bit
    output wire              subtract_o    // the magnitudes are subtracted
);
    // A subnormal has the exponent of the smallest normal number.
    wire [EXP-1:0] field_a = a_i[FRAC +: EXP], exp_a = field_a | {{EXP-1{1'b0}}, field_a == 0};
    wire [EXP-1:0] field_b = b_i[FRAC +: EXP], exp_b = field_b | {{EXP-1{1'b0}}, field_b == 0};

    assign distance_o = exp_a > exp_b ? exp_a - exp_b : exp_b - exp_a;
    assign far_o      = distance_o > FRAC + 3;
    assign subtract_o = a_i[EXP+FRAC] ^ b_i[EXP+FRAC] ^ sub_i;
endmodule
`default_nettype wire
