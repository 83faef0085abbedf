// SPDX-License-Identifier: Apache-2.0
// fp3_decode: decodes an instruction word, and says whether this build can execute it.
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
module fp3_decode #(
`include "config/config.vh"
) (
    input  wire [31:0]           word_i,
    output wire [`FP3_DECODED_W-1:0] decoded_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"
`include "gen/choice_of.vh"
`include "gen/operands.vh"
    `FP3_DECODED_FIELDS
    assign decoded_o = `FP3_DECODED;

    // With NEIGHBOURS the path from the word to the register behind decode is long. So op has the
    // codes of field op only, and the codes of field c (all of them for neighbours) are decoded
    // beside it.
    wire              is_more = NEIGHBOURS != 0 && more_code(word_i);
    wire [CODE_W-1:0] more    = {1'b1, word_i[C_HI:C_LO]};
    wire [CODE_W-1:0] op      = NEIGHBOURS != 0 ? {{CODE_W-1-OP_HI+OP_LO{1'b0}}, word_i[OP_HI:OP_LO]} : code_of(word_i);
    wire [5:0] field_d = word_i[D_HI:D_LO];
    wire [6:0] field_a = word_i[A_HI:A_LO];
    wire [6:0] field_b = word_i[B_HI:B_LO];
    wire [6:0] field_c = more_code(word_i) ? 7'd0 : word_i[C_HI:C_LO];

    // What goes with neighbours
    wire loads_word  = is_more && more == OP_LDN;
    wire loads_field = is_more && more == OP_LDL;
    wire takes_word  = is_more && (more == OP_ADDN || more == OP_SUBN || more == OP_RSBN || more == OP_MULN);
    wire takes_field = is_more && (more == OP_ADDL || more == OP_SUBL || more == OP_RSBL || more == OP_MULL);
    wire takes_mul   = is_more && (more == OP_MULN || more == OP_MULL);
    assign stl       = is_more && more == OP_STL;
    assign each      = is_more && more == OP_EACH;
    assign next      = is_more && more == OP_NEXT;
    assign repeats   = is_more && more == OP_REPEAT;
    assign returns   = is_more && more == OP_AGAIN;
    assign keeps     = KEEP != 0 && is_more && more == OP_KEEP;
    assign raises    = KEEP != 0 && is_more && more == OP_RAISE;
    assign holds     = KEEP != 0 && is_more && more == OP_HOLD;
    assign phase     = (is_more && more == OP_PHASE) || repeats || returns || holds;
    assign takes     = takes_word || takes_field;
    assign flips     = is_more && (more == OP_RSBN || more == OP_RSBL);
    assign ldn       = loads_word || takes_word || keeps;
    assign ldl       = loads_field || takes_field;

    // Where it goes
    wire valued = choice != CHOICE_NONE;
    assign choice    = choice_of(op);
    assign halve      = SCALE != 0 && (op == OP_ADDH || op == OP_SUBH);
    assign twice     = SCALE != 0 && (op == OP_ADDT || op == OP_SUBT);
    wire plain_add   = op == OP_ADD || op == OP_SUB || halve || twice || (valued && DUAL == 0);
    assign to_add    = plain_add || (takes && !takes_mul);
    assign to_mul    = op == OP_MUL || takes_mul || (valued && DUAL != 0);
    assign to_chain  = (CHAIN != 0 && (op == OP_MADD || op == OP_MSUB)) || (FUSED != 0 && (op == OP_FMADD || op == OP_FMSUB));
    assign subtract  = op == OP_SUB || op == OP_MSUB || op == OP_FMSUB || op == OP_SUBH || op == OP_SUBT
                    || (is_more && (more == OP_SUBN || more == OP_SUBL));
    assign to_sleep  = SLEEP != 0 && op == OP_SLEEP;
    wire plain_st    = INTERLEAVE != 0 && op == OP_ST;
    assign st        = plain_st || stl;
    assign lds       = INTERLEAVE != 0 && SLEEP != 0 && op == OP_LDS;
    wire plain_memory = plain_st || lds || (INTERLEAVE != 0 && op == OP_LD);
    assign to_memory  = plain_memory || stl || each || next || loads_word || loads_field || keeps || raises;

    // Sums and products apart: each writes its bank, and reads at most one register of each bank. A
    // scaled operand is b, which is then not in the bank of sums. What fp_value makes is made in a
    // product's place, of a sum.
    wire a_even = !field_a[6] && !field_a[0], a_odd = !field_a[6] && field_a[0];
    wire b_even = !field_b[6] && !field_b[0], b_odd = !field_b[6] && field_b[0];
    wire apart  = !(has_b(op) && ((a_even && b_even) || (a_odd && b_odd)))
               && !((halve || twice) && (a_odd || b_even))
               && !(valued && a_odd);
    wire banked = DUAL == 0 || to_memory || (apart && field_d[0] == to_mul);

    // An index fits if shifting out the bits that the register file has leaves nothing.
    wire in_range = ((field_d      >> REGISTER_W) == 6'd0)
                 && ((field_a[5:0] >> REGISTER_W) == 6'd0)
                 && ((field_b[5:0] >> REGISTER_W) == 6'd0)
                 && ((field_c[5:0] >> REGISTER_W) == 6'd0);
    wire extra    = (!has_a(op) && field_a != 7'd0) || (!has_b(op) && field_b != 7'd0)
                 || (!has_c(op) && field_c != 7'd0);
    generate
        if (NEIGHBOURS != 0) begin : g_looped
            wire plain   = plain_add || op == OP_MUL || to_chain || to_sleep || plain_memory;
            wire looped  = takes || keeps || ((loads_word || stl || field_a == 7'd0) && field_b == 7'd0
                                     && (each || next || loads_word || loads_field || stl || phase || raises));
            assign legal = in_range && ((plain && !extra) || looped);
            wire unused  = banked;
        end else begin : g_plain
            assign legal = in_range && !extra && banked && (to_add || to_mul || to_chain || to_sleep || to_memory || phase);
        end
    endgenerate

    // The operands
    wire [REGISTER_W:0] first  = {field_a[6], field_a[REGISTER_W-1:0]};
    wire [REGISTER_W:0] second = {field_b[6], field_b[REGISTER_W-1:0]};
    wire [REGISTER_W:0] third  = {field_c[6], field_c[REGISTER_W-1:0]};
    assign d = field_d[REGISTER_W-1:0];
    assign a = choice == CHOICE_SEL ? third : first;
    assign b = has_b(op) || takes || keeps ? second : first;
    assign c = (FUSED != 0 && INTERLEAVE == 0 ? !to_chain : valued) ? first : third;
endmodule
`default_nettype wire
`include "config/undefine.vh"
