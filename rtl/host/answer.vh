// SPDX-License-Identifier: Apache-2.0
// answer.vh: the bundle ANSWER of a host port. All 0 in a cycle without an answer, so that the hub
// can OR answers. front/decoded.vh shows how a bundle is used.
//
//     wrote, write_error          a write is answered
//     read, read_error, rdata     a read is answered
`define FP3_ANSWER_W 36
`define FP3_ANSWER_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire answer_wrote, answer_write_error, answer_read, answer_read_error; \
    wire [31:0] answer_rdata; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_ANSWER {answer_wrote, answer_write_error, answer_read, answer_read_error, answer_rdata}
