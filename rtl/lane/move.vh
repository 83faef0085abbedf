// SPDX-License-Identifier: Apache-2.0
// move.vh: the bundle MOVE, the words that a lane loads from its store and stores there.
// front/decoded.vh shows how a bundle is used. lane_store says in which cycle each is.
//
//     record_shift                a record has 8 << record_shift words
//     st, in_last, register       a store: in the last part of a visit; of which register
//     st_row, st_absent, st_asleep   of which object, two cycles later: there is none, it sleeps
//     load                        a word is loaded
//     load_row, load_register     which one; or, without load, the row that is looked at
//     st_upper, load_upper        in the upper half of the store
//     st_whole, load_whole        with STORAGE: all 32 bits
//     load_place, place           not a word of a record, but this one
`define FP3_MOVE_W (12 + STORE_W + 2*REGISTER_W + 2*ROW_W)
`define FP3_MOVE_FIELDS \
    wire [1:0] move_record_shift; \
    wire move_st, move_in_last, move_st_absent, move_st_asleep, move_load, move_st_upper, move_load_upper, move_load_place, move_st_whole, move_load_whole; \
    wire [REGISTER_W-1:0] move_register, move_load_register; \
    wire [ROW_W-1:0] move_st_row, move_load_row; \
    wire [STORE_W-1:0] move_place;
`define FP3_MOVE {move_record_shift, move_st, move_in_last, move_st_absent, move_st_asleep, move_load, move_register, move_load_register, \
    move_st_upper, move_load_upper, move_load_place, move_st_whole, move_load_whole, move_st_row, move_load_row, move_place}
