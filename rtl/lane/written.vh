// SPDX-License-Identifier: Apache-2.0
// written.vh: the bundle WRITTEN, an instruction's end in a lane, for the trace alone: left open,
// it costs nothing. front/decoded.vh shows how a bundle is used. Its widths are those of fp3's
// ports.
//
//     end                         0: none; 1: the context has no object; 2: it sleeps; 3: executed
//     valid                       a register is written
//     context, object, register   of which context, of the object in which row of the store, which one
//     value, flags
`define FP3_WRITTEN_W 94
`define FP3_WRITTEN_FIELDS \
    wire [1:0] written_end; \
    wire written_valid; \
    wire [15:0] written_context; \
    wire [31:0] written_object; \
    wire [5:0] written_register; \
    wire [31:0] written_value; \
    wire [4:0] written_flags;
`define FP3_WRITTEN {written_end, written_valid, written_context, written_object, written_register, written_value, written_flags}
