// SPDX-License-Identifier: Apache-2.0
// retire.vh: the bundle RETIRE, which goes from lane to lane TO_END cycles after ISSUE: what the
// end of an instruction needs.
// front/decoded.vh shows how a bundle is used.
//
//     round                       a round begins; says nothing of the other fields
//     valid                       an instruction ends; without it only context and register are set
//     begins, ends, in_last       the first, the last of a visit; in its last part
//     lds, sleep, load, arithmetic   what it does; a store does none of these
//     whole                       it loads all 32 bits of its word, with STORAGE
//     batch                       two batches in a row differ in it
//     context, register           whose register is written
//     row                         the store's row of the context's object, without SLEEP
`define FP3_RETIRE_W (11 + REG_W + ROW_W)
`define FP3_RETIRE_FIELDS \
    wire retire_round, retire_valid, retire_begins, retire_ends, retire_in_last; \
    wire retire_lds, retire_sleep, retire_load, retire_arithmetic, retire_whole, retire_batch; \
    wire [CONTEXT_W-1:0] retire_context; \
    wire [REGISTER_W-1:0] retire_register; \
    wire [ROW_W-1:0] retire_row;
`define FP3_RETIRE {retire_round, retire_valid, retire_begins, retire_ends, retire_in_last, \
    retire_lds, retire_sleep, retire_load, retire_arithmetic, retire_whole, retire_batch, retire_context, retire_register, retire_row}
