// SPDX-License-Identifier: Apache-2.0
// draw.vh: the bundle DRAW, which goes from lane to lane TIMING_MIX + 1 cycles after ISSUE: how a
// store is rounded. One bit, 0, where the store has words of 32 bits.
// front/decoded.vh shows how a bundle is used.
//
//     draws                       at random; else to nearest
//     number                      what the draw of the object in lane 0 is mixed from; the next lane's is one more. With SLEEP
//                                 each lane adds its object's number:
//     first, stride               first + l + r * stride in row r of lane l
`define FP3_DRAW_FIELDS \
    wire draw_draws; \
    wire [31:0] draw_number, draw_first; \
    wire [12:0] draw_stride;
`define FP3_DRAW {draw_draws, draw_number, draw_first, draw_stride}
