// fp_scale: twice or half of a number, without a multiplier.
//
// Purpose   The same bits and flags as a product with 2 or 1/2. Only the exponent changes, unless
//           the result is not a normal number.
// Latency   0.
// Options   SUBNORMAL = 0 and NEAREST = 0 as in fp_mul.
// Promise   With neither twice_i nor half_i, z_o is d_i, bit by bit, and no flag rises: a subnormal
//           passes even with SUBNORMAL = 0, where the adder behind reads it as zero.
//           A NaN passes unchanged: the adder behind makes it quiet, and raises invalid for a
//           signalling one as a product would.
//           Proved for every number and option: tests/formal/scale_cases.v.
// Hazard    Never twice_i and half_i together (shared_arith checks it).
//
//     d_i 00800001, half_i 1  ->  z_o 00400000 (a tie, to even), flags_o underflow, inexact
`default_nettype none
module fp_scale #(
    parameter EXP       = 8,
    parameter FRAC      = 23,
    parameter SUBNORMAL = 1,
    parameter NEAREST   = 1
) (
    input  wire              twice_i,  // times 2
    input  wire              half_i,   // times 1/2; neither: as it is
    input  wire [EXP+FRAC:0] d_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o   // {NV, DZ, OF, UF, NX}
);
    wire               sign = d_i[EXP+FRAC];
    wire [EXP-1:0]     e    = d_i[EXP+FRAC-1:FRAC];
    wire [FRAC-1:0]    f    = d_i[FRAC-1:0];
    wire               top  = &e;                         // infinity or NaN
    wire               low  = e == {EXP{1'b0}};           // zero or subnormal
    localparam [EXP-1:0] ONE = 1;

    // Twice: a subnormal's fraction moves, its top bit into the exponent; the largest overflow.
    wire               over  = twice_i && e == {{EXP-1{1'b1}}, 1'b0};
    wire [EXP+FRAC-1:0] up   = low ? {{EXP-1{1'b0}}, f, 1'b0} : {e + 1'b1, f};
    wire [EXP+FRAC-1:0] most = NEAREST != 0 ? {{EXP{1'b1}}, {FRAC{1'b0}}} : {{EXP-1{1'b1}}, 1'b0, {FRAC{1'b1}}};

    // Half: what is or becomes subnormal moves and is rounded.
    wire               lowest = low || e == ONE;
    wire [FRAC:0]      moved = {1'b0, !low, f[FRAC-1:1]};
    wire               round = NEAREST != 0 && f[0] && f[1];
    wire [FRAC:0]      tiny  = moved + {{FRAC{1'b0}}, round};
    wire [EXP+FRAC-1:0] down = lowest ? {{EXP-1{1'b0}}, tiny} : {e - 1'b1, f};

    wire flushed = SUBNORMAL == 0 && (low || (half_i && e == ONE));
    wire scaled  = (twice_i || half_i) && !top;
    wire [EXP+FRAC-1:0] z = !scaled ? d_i[EXP+FRAC-1:0] : flushed ? {EXP+FRAC{1'b0}}
                          : over ? most : half_i ? down : up;
    wire of = scaled && over;
    wire uf = scaled && half_i && lowest && (SUBNORMAL != 0 ? f[0] : !low);
    assign z_o     = {sign, z};
    assign flags_o = {2'b00, of, uf, of || uf};
endmodule
`default_nettype wire
