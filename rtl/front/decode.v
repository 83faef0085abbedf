// decode: what an instruction word asks for, and whether this build can do it.
//
// Purpose   The only reader of the instruction set's fields in hardware.
// Latency   0.
// Promise   legal_o is low for an unknown opcode, an operand beyond the register file, a field
//           that the instruction does not have and that is not 0, and a unit left out.
//
//     word_i = 0x0820c100       legal_o, to_add_o, d_o = 1, a_o = {0, 3}, b_o = {0, 2}
`default_nettype none
module decode #(
    parameter REGISTER_W = 5,          // 2^REGISTER_W registers, and as many constants
    parameter CHAIN      = 1,          // madd and msub are built
    parameter SCALE      = 0,          // addh, subh, addt, subt
    parameter SELECT     = 0,          // min, max, abs, lt, le, sel
    parameter ESTIMATE   = 0,          // rcp, rsqrt
    parameter SLEEP      = 0,          // sleep and lds
    parameter STORE      = 0           // ld, lds and st
) (
    input  wire [31:0]           word_i,
    output wire                  legal_o,
    output wire                  to_add_o,    // exactly one of these five, if legal
    output wire                  to_mul_o,
    output wire                  to_chain_o,  // to the multiplier, and on to the adder
    output wire                  to_sleep_o,
    output wire                  to_memory_o,
    output wire                  subtract_o,
    output wire                  st_o,        // which of those to memory
    output wire                  lds_o,
    output wire                  twice_o,     // what b is multiplied with, in an addition
    output wire                  half_o,
    output wire [3:0]            kind_o,      // what fp_value does to c, in an addition
    output wire [REGISTER_W-1:0] d_o,
    output wire [REGISTER_W:0]   a_o,         // {shared constant, index}
    output wire [REGISTER_W:0]   b_o,
    output wire [REGISTER_W:0]   c_o
);
`include "gen/isa.vh"
`include "fp/value.vh"

    wire [4:0] op = word_i[OP_HI:OP_LO];
    wire [5:0] d  = word_i[D_HI:D_LO];
    wire [6:0] a  = word_i[A_HI:A_LO];
    wire [6:0] b  = word_i[B_HI:B_LO];
    wire [6:0] c  = word_i[C_HI:C_LO];

    wire [3:0] kind = SELECT != 0 && op == OP_MIN     ? VALUE_MIN
                    : SELECT != 0 && op == OP_MAX     ? VALUE_MAX
                    : SELECT != 0 && op == OP_ABS     ? VALUE_ABS
                    : SELECT != 0 && op == OP_LT      ? VALUE_LT
                    : SELECT != 0 && op == OP_LE      ? VALUE_LE
                    : SELECT != 0 && op == OP_SEL     ? VALUE_SEL
                    : ESTIMATE != 0 && op == OP_RCP   ? VALUE_RCP
                    : ESTIMATE != 0 && op == OP_RSQRT ? VALUE_RSQRT : VALUE_PLAIN;
    wire value  = kind != VALUE_PLAIN;
    assign kind_o = kind;

    assign half_o     = SCALE != 0 && (op == OP_ADDH || op == OP_SUBH);
    assign twice_o    = SCALE != 0 && (op == OP_ADDT || op == OP_SUBT);
    assign to_add_o   = op == OP_ADD || op == OP_SUB || half_o || twice_o || value;
    assign to_mul_o   = op == OP_MUL;
    assign to_chain_o = CHAIN != 0 && (op == OP_MADD || op == OP_MSUB);
    assign subtract_o = op == OP_SUB || op == OP_MSUB || op == OP_SUBH || op == OP_SUBT;

    // An index fits if shifting out the bits that the register file has leaves nothing.
    wire in_range = ((d      >> REGISTER_W) == 6'd0)
                 && ((a[5:0] >> REGISTER_W) == 6'd0)
                 && ((b[5:0] >> REGISTER_W) == 6'd0)
                 && ((c[5:0] >> REGISTER_W) == 6'd0);

    assign to_sleep_o  = SLEEP != 0 && op == OP_SLEEP;
    assign st_o        = STORE != 0 && op == OP_ST;
    assign lds_o       = STORE != 0 && SLEEP != 0 && op == OP_LDS;
    assign to_memory_o = st_o || lds_o || (STORE != 0 && op == OP_LD);

    wire sel    = kind == VALUE_SEL;
    wire no_b   = kind == VALUE_ABS || kind == VALUE_RCP || kind == VALUE_RSQRT;
    wire rest   = (to_add_o && !sel) || to_mul_o || to_sleep_o;
    wire a_is_0 = a == 7'd0, b_is_0 = b == 7'd0, c_is_0 = c == 7'd0;
    assign legal_o = in_range && (to_chain_o || sel || (rest && c_is_0 && (b_is_0 || !no_b))
                                             || (to_memory_o && a_is_0 && b_is_0 && c_is_0));

    // Where fp_value works, the sum's operand c is a, and a says what sel chooses. What the instruction
    // does not have repeats a, so that nobody waits for it.
    wire [REGISTER_W:0] a_is = {a[6], a[REGISTER_W-1:0]};
    wire [REGISTER_W:0] b_is = {b[6], b[REGISTER_W-1:0]};
    wire [REGISTER_W:0] c_is = {c[6], c[REGISTER_W-1:0]};
    assign d_o = d[REGISTER_W-1:0];
    assign a_o = sel   ? c_is : a_is;
    assign b_o = no_b  ? a_is : b_is;
    assign c_o = value ? a_is : c_is;
endmodule
`default_nettype wire
