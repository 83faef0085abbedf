// fma_cases: the case that the operands of z + x * y or z - x * y fall in, and normal factors in place of one that is subnormal.
//
// A subnormal factor is shifted left until it is normal, and the other factor's exponent is reduced by as much: the exact product
// stays the same. This needs the other factor's exponent to stay above 0.
`default_nettype none
module fma_cases #(
    parameter EXP = 8, FRAC = 23, SUBNORMAL = 1
) (
    input  wire [EXP+FRAC:0] x_i, y_i, z_i,
    input  wire              subtract_i,
    output wire [EXP+1:0]    distance_o,   // of the exponents: z's less the product's, plus 2 * FRAC + 6; if it is in 0 .. 3 * FRAC + 12
    output wire              below_o,      // less: z is only a sticky bit
    output wire              above_o,      // more: the product is
    output wire              minus_o,      // the magnitudes are subtracted
    output wire              plain_o,      // both factors are normal
    output wire              tiny_o,       // none is
    output wire [5:0]        zeros_o,      // in front of the significand of the one that is subnormal
    output wire              movable_o,    // there is one, and the other is finite and stays normal
    output wire [EXP+FRAC:0] moved_x_o, moved_y_o   // the same product of normal factors, if movable_o
);
    // A subnormal has the exponent of the smallest normal number.
    wire [EXP-1:0] field_x = x_i[FRAC +: EXP], exp_x = field_x | {{EXP-1{1'b0}}, field_x == 0};
    wire [EXP-1:0] field_y = y_i[FRAC +: EXP], exp_y = field_y | {{EXP-1{1'b0}}, field_y == 0};
    wire [EXP-1:0] field_z = z_i[FRAC +: EXP], exp_z = field_z | {{EXP-1{1'b0}}, field_z == 0};
    wire [EXP+3:0] from = exp_z + ((1 << EXP) / 2 - 1) + 2 * FRAC + 6;
    wire [EXP+3:0] sum  = exp_x + exp_y;
    wire [EXP+3:0] distance = from - sum;

    assign below_o    = distance[EXP+3];
    assign above_o    = !below_o && distance > 3 * FRAC + 12;
    assign distance_o = distance[EXP+1:0];
    assign minus_o    = x_i[EXP+FRAC] ^ y_i[EXP+FRAC] ^ z_i[EXP+FRAC] ^ subtract_i;
    assign plain_o    = field_x != 0 && field_y != 0;
    assign tiny_o     = field_x == 0 && field_y == 0;

    wire [FRAC-1:0] fraction = field_x == 0 ? x_i[FRAC-1:0] : y_i[FRAC-1:0];
    reg [5:0] zeros;
    integer   i;
    always @* begin
        zeros = FRAC + 1;
        for (i = 0; i < FRAC; i = i + 1) if (fraction[i]) zeros = FRAC - i;
    end
    assign zeros_o    = zeros;

    wire [EXP-1:0]  other  = field_x == 0 ? field_y : field_x;
    wire [FRAC-1:0] normal = fraction << zeros;
    wire [EXP:0]    less   = {1'b0, other} - zeros;
    localparam [EXP-1:0] ONE = 1;
    assign movable_o = SUBNORMAL != 0 && !plain_o && |fraction && !(&other) && !less[EXP] && |less;
    assign moved_x_o = {x_i[EXP+FRAC], field_x == 0 ? {ONE, normal} : {less[EXP-1:0], x_i[FRAC-1:0]}};
    assign moved_y_o = {y_i[EXP+FRAC], field_x == 0 ? {less[EXP-1:0], y_i[FRAC-1:0]} : {ONE, normal}};
endmodule
`default_nettype wire
