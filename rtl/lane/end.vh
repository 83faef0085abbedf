// SPDX-License-Identifier: Apache-2.0
// end.vh: the bundle END, the end of an instruction in a lane, in the cycle W of its result.
// front/decoded.vh shows how a bundle is used.
//
//     valid, absent, executed     one ends; there is no object for it; it is executed: only if valid and not absent
//     writes                      a register is written
//     arithmetic                  its value is the arithmetic's, else a loaded word or the number of the step
//     register                    {context, register}
//     row                         the object's, a cycle later: for the trace
`define FP3_END_W (5 + REG_W + ROW_W)
`define FP3_END_FIELDS \
    wire end_valid, end_absent, end_executed, end_writes, end_arithmetic; \
    wire [REG_W-1:0] end_register; \
    wire [ROW_W-1:0] end_row;
`define FP3_END {end_valid, end_absent, end_executed, end_writes, end_arithmetic, end_register, end_row}
