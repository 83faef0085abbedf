// decode: what an instruction word asks for, and whether this build can do it.
//
// Purpose   The only reader of the instruction set's fields in hardware.
// Latency   0.
// Promise   legal is low for an unknown opcode, an operand beyond the register file, a field
//           that the instruction does not have and that is not 0, a unit left out, and with DUAL
//           registers of the wrong bank.
//
//     word_i = 0x0820c100       legal, to_add, d = 1, a = {0, 3}, b = {0, 2}
`default_nettype none
`include "front/decoded.vh"
module decode #(
`include "config/config.vh"
) (
    input  wire [31:0]           word_i,
    output wire [`DECODED_W-1:0] decoded_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"
`include "gen/choice_of.vh"
`include "gen/operands.vh"
    `DECODED_FIELDS
    assign decoded_o = `DECODED;

    wire [CODE_W-1:0] op = code_of(word_i);
    wire [5:0] field_d = word_i[D_HI:D_LO];
    wire [6:0] field_a = word_i[A_HI:A_LO];
    wire [6:0] field_b = word_i[B_HI:B_LO];
    wire [6:0] field_c = more_code(word_i) ? 7'd0 : word_i[C_HI:C_LO];

    // Where it goes
    wire valued = choice != CHOICE_NONE;
    assign choice    = choice_of(op);
    assign half      = SCALE != 0 && (op == OP_ADDH || op == OP_SUBH);
    assign twice     = SCALE != 0 && (op == OP_ADDT || op == OP_SUBT);
    assign to_add    = op == OP_ADD || op == OP_SUB || half || twice || valued;
    assign to_mul    = op == OP_MUL;
    assign to_chain  = CHAIN != 0 && (op == OP_MADD || op == OP_MSUB);
    assign subtract  = op == OP_SUB || op == OP_MSUB || op == OP_SUBH || op == OP_SUBT;
    assign to_sleep  = SLEEP != 0 && op == OP_SLEEP;
    assign st        = INTERLEAVE != 0 && op == OP_ST;
    assign lds       = INTERLEAVE != 0 && SLEEP != 0 && op == OP_LDS;
    assign each      = NEIGHBOURS != 0 && op == OP_EACH;
    assign next      = NEIGHBOURS != 0 && op == OP_NEXT;
    assign ldn       = NEIGHBOURS != 0 && op == OP_LDN;
    assign ldl       = NEIGHBOURS != 0 && op == OP_LDL;
    assign phase     = NEIGHBOURS != 0 && op == OP_PHASE;
    assign to_memory = st || lds || each || next || ldn || ldl || (INTERLEAVE != 0 && op == OP_LD);

    // An index fits if shifting out the bits that the register file has leaves nothing.
    wire in_range = ((field_d      >> REGISTER_W) == 6'd0)
                 && ((field_a[5:0] >> REGISTER_W) == 6'd0)
                 && ((field_b[5:0] >> REGISTER_W) == 6'd0)
                 && ((field_c[5:0] >> REGISTER_W) == 6'd0);
    wire extra    = (!has_a(op) && field_a != 7'd0) || (!has_b(op) && field_b != 7'd0)
                 || (!has_c(op) && field_c != 7'd0);
    assign legal  = in_range && !extra && banked && (to_add || to_mul || to_chain || to_sleep || to_memory || phase);

    // Sums and products apart: each writes its bank, and reads at most one register of each; of what is scaled
    // only b is, which then is none of the sums.
    wire a_even = !field_a[6] && !field_a[0], a_odd = !field_a[6] && field_a[0];
    wire b_even = !field_b[6] && !field_b[0], b_odd = !field_b[6] && field_b[0];
    wire apart  = !(has_b(op) && ((a_even && b_even) || (a_odd && b_odd)))
               && !((half || twice) && (a_odd || b_even));
    wire banked = DUAL == 0 || to_memory || (apart && field_d[0] == to_mul);

    // The operands
    wire [REGISTER_W:0] first  = {field_a[6], field_a[REGISTER_W-1:0]};
    wire [REGISTER_W:0] second = {field_b[6], field_b[REGISTER_W-1:0]};
    wire [REGISTER_W:0] third  = {field_c[6], field_c[REGISTER_W-1:0]};
    assign d = field_d[REGISTER_W-1:0];
    assign a = choice == CHOICE_SEL ? third : first;
    assign b = has_b(op) ? second : first;
    assign c = valued ? first : third;
endmodule
`default_nettype wire
