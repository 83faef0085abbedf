// SPDX-License-Identifier: Apache-2.0
// marks.vh: the bundle MARKS, an instruction's place in its visit: from fetch, through the sweep,
// to issue. Used as decoded.vh shows.
//
//     begins, ends                the first, the last of the visit
//     newstep                     the first of a step
//     in_last                     in the last part
`define FP3_MARKS {begins, ends, newstep, in_last}
`define FP3_MARKS_W 4
`define FP3_MARKS_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire begins, ends, newstep, in_last; /* verilator lint_on UNUSEDSIGNAL */
