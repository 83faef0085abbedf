// SPDX-License-Identifier: Apache-2.0
// issued.vh: the bundle ISSUED, an instruction that issues, for the trace alone: left open, it
// costs nothing. front/decoded.vh shows how a bundle is used. Its widths are those of fp3's ports.
//
//     valid                       an instruction issues
//     pc, word                    from where in the program
//     context                     for which context
`define FP3_ISSUED_W 65
`define FP3_ISSUED_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire issued_valid; \
    wire [15:0] issued_pc, issued_context; \
    wire [31:0] issued_word; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_ISSUED {issued_valid, issued_pc, issued_context, issued_word}
