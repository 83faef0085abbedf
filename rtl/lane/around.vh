// SPDX-License-Identifier: Apache-2.0
// around.vh: the bundle AROUND: how an instruction uses an object's neighbours. From the
// sequencer's loops to the lane's lists; one bit, 0, without NEIGHBOURS. front/decoded.vh shows how
// a bundle is used.
//
//     each                        a loop begins: the register has the place and the length of the object's list
//     entry                       the next neighbour of the list is found (each, next)
//     ldn, ldl                    a word of the neighbour's record, or a field of its entry, is loaded or computed with
//     inside                      in a loop: not for objects whose list has ended
//     half                        of the store: 1: the upper one, where published words are loaded or stored
//     turn                        of the loop, from 0
//     offset                      in the list, of an entry or a field; else the number of a word, of the neighbour's record or the own
`define FP3_AROUND_FIELDS \
    wire around_each, around_entry, around_ldn, around_ldl, around_inside, around_half; \
    wire [LENGTH_W-1:0] around_turn; \
    wire [STORE_W-1:0] around_offset;
`define FP3_AROUND {around_each, around_entry, around_ldn, around_ldl, around_inside, around_half, around_turn, around_offset}
