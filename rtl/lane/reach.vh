// SPDX-License-Identifier: Apache-2.0
// reach.vh: the bundle REACH, which goes from lane to lane AHEAD cycles before ISSUE: the word of
// the store that an instruction reads, in time for the operands. One bit, 0, without NEIGHBOURS:
// then RETIRE has this read, later. front/decoded.vh shows how a bundle is used.
//
//     valid, load                 an instruction; it reads a word
//     copy                        no instruction: the lane of number `turn` in around says a word of its store (sequence/fp3_exchange.v)
//     context                     whose neighbour it is
//     row                         the store's row of the context's object
//     around                      lane/around.vh
`define FP3_REACH_W (NEIGHBOURS != 0 ? 3 + CONTEXT_W + ROW_W + AROUND_W : 1)
`define FP3_REACH_FIELDS \
    wire reach_valid, reach_load, reach_copy; \
    wire [CONTEXT_W-1:0] reach_context; \
    wire [ROW_W-1:0] reach_row; \
    wire [AROUND_W-1:0] reach_around;
`define FP3_REACH {reach_valid, reach_load, reach_copy, reach_context, reach_row, reach_around}
