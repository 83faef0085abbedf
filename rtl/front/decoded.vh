// SPDX-License-Identifier: Apache-2.0
// decoded.vh: the decoded instruction as a bundle, its fields, order and width. Included before a
// module that names CONFIG's keys; both ends declare the fields and name the bundle:
//
//     `FP3_DECODED_FIELDS                    // of a decode that gives it: assign decoded_o = `FP3_DECODED;
//     assign `FP3_DECODED = decoded_q;       // where it is taken apart
//
// legal                      this build can execute it; nothing else counts if not
// to_add .. to_memory        exactly one of these five, but for phase: its counter, and where it goes. to_chain: to
//                            the multiplier, and on to the adder
// subtract                   the sum is a difference
// st .. ldl                  which instruction to memory: each and next find a neighbour there. st is also `stl`, with stl
// ldn, ldl                   also arithmetic with the word that they would load: takes. flips: the sum's other operand
//                            has the other sign. ldn is also `keep`, which asks for the neighbour's row
// phase                      it goes nowhere: `phase`, `repeat`, `again` or `hold`
// repeats, returns           ... of these the second or the third; d says how often
// keeps, raises              `keep`, `raise`
// holds                      a phase ends that has stored nothing published; d words are left out unless an object has raised
// twice, halve               what b is multiplied with, in an addition
// choice                     what fp_value makes of c, in an addition: gen/choices.vh
// d; a, b, c                 a register; {shared constant, index} each. Where fp_value works, c is the
//                            sum's operand and a says what sel chooses; an operand that the
//                            instruction does not have repeats a, so that no instruction waits for it
`define FP3_DECODED {legal, to_add, to_mul, to_chain, to_sleep, to_memory, subtract, st, lds, each, next, ldn, ldl, stl, \
    takes, flips, phase, repeats, returns, keeps, raises, holds, twice, halve, choice, d, a, b, c}
`define FP3_DECODED_W (24 + CHOICE_W + REGISTER_W + 3 * (REGISTER_W + 1))
`define FP3_DECODED_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire legal, to_add, to_mul, to_chain, to_sleep, to_memory, subtract; \
    wire st, lds, each, next, ldn, ldl, stl, takes, flips, phase, repeats, returns, keeps, raises, holds, twice, halve; \
    wire [CHOICE_W-1:0]   choice; \
    wire [REGISTER_W-1:0] d; \
    wire [REGISTER_W:0]   a, b, c; /* verilator lint_on UNUSEDSIGNAL */
