// SPDX-License-Identifier: Apache-2.0
// report.vh: the bundle REPORT, which goes from lane to lane and back to the sequencer. Each lane
// adds what it has to say.
// front/decoded.vh shows how a bundle is used.
//
//     count                       the most objects that a lane will visit
//     longest                     list of neighbours of the contexts of a loop that begins
//     flags                       exceptions raised in this cycle
//     answer                      to the host
//     valid                       asleep is news: of a context, in a batch
//     asleep                      no lane has this context awake
`define FP3_REPORT_W (41 + ROW_W + CONTEXT_W + LENGTH_W)
`define FP3_REPORT_FIELDS \
    wire [ROW_W:0] report_count; \
    wire [LENGTH_W-1:0] report_longest; \
    wire [4:0] report_flags; \
    wire [31:0] report_answer; \
    wire report_valid, report_asleep, report_batch; \
    wire [CONTEXT_W-1:0] report_context;
`define FP3_REPORT_OF(count, longest, flags, answer, valid, asleep, batch, number) {count, longest, flags, answer, valid, asleep, batch, number}
`define FP3_REPORT `FP3_REPORT_OF(report_count, report_longest, report_flags, report_answer, report_valid, report_asleep, report_batch, report_context)
// In front of the first lane: no object, no flag, none awake.
`define FP3_REPORT_NONE `FP3_REPORT_OF({ROW_W+1{1'b0}}, {LENGTH_W{1'b0}}, 5'd0, 32'd0, 1'b0, 1'b1, 1'b0, {CONTEXT_W{1'b0}})
