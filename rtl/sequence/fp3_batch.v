// SPDX-License-Identifier: Apache-2.0
// fp3_batch: which contexts have an object in this visit, and which of these objects are awake.
//
// Purpose   A round visits its objects batch by batch; a batch has at most one object per context.
//           Fetch runs ahead of decode, perhaps into the next batch, so fetch and decode count
//           batches separately. Decode asks which contexts an instruction is for:
//
//           the first of a visit    all that get an object        the next batch is this one from then on
//           in the last part        all that have one             an object that fell asleep is stored, too
//           any other               all that are awake
//
// Latency   mask_o is that of the instruction that decode takes; a report changes it two cycles
//           later. A report comes some cycles after an object fell asleep. Until then instructions
//           still issue for the object (no lane executes them); afterwards they do not.
// Hazard    Each report is about a context that has an object, and comes before the next round
//           opens.
//
//     CONTEXTS = 4, count_i = 6:       mask_o of ld  1111   of add  1111   after a report of context 2  1011
//                   the second batch:                0011           0011
`default_nettype none
module fp3_batch #(
    parameter CONTEXTS  = 24,
    parameter CONTEXT_W = 5,           // bits of a context's number, and of a row's
    parameter ROW_W     = 7
) (
    input  wire                  clk_i,
    input  wire                  rst_i,
    input  wire                  open_i,      // a round begins ...
    input  wire [ROW_W:0]        count_i,     // ... objects in the fullest lane
    // Fetch
    input  wire                  again_i,     // fetch begins the next batch
    output wire                  more_o,      // there is a next batch
    output wire                  skip_o,      // no object of fetch's batch is awake
    // Decode
    input  wire                  take_i,      // an instruction is taken ...
    input  wire                  begins_i,    // ... the first of a visit
    input  wire                  in_last_i,     // ... in the last part
    output wire [CONTEXTS-1:0]   mask_o,
    output wire                  batch_o,     // two batches in a row differ in it
    // From the last lane
    input  wire                  valid_i,     // the object in a context sleeps, or is awake
    input  wire                  asleep_i,
    input  wire                  reported_batch_i,
    input  wire [CONTEXT_W-1:0]  reported_context_i
);
    localparam [ROW_W:0] CONTEXTS_R = CONTEXTS[ROW_W:0];

    // Fetch's count of batches
    reg           fetch_batch_q, more_q, skip_q;
    reg [ROW_W:0] fetch_left_q;        // objects not yet in a batch that fetch has begun
    always @(posedge clk_i)
        if (open_i) begin
            fetch_left_q  <= count_i;
            fetch_batch_q <= 1'b1;
            more_q        <= count_i > CONTEXTS_R;
        end else if (again_i) begin
            fetch_left_q  <= fetch_left_q - CONTEXTS_R;
            fetch_batch_q <= !fetch_batch_q;
            more_q        <= {1'b0, fetch_left_q} > {CONTEXTS_R, 1'b0};
        end

    // Decode's
    reg                 batch_q;
    reg [ROW_W:0]       left_q;        // objects not yet in a batch that decode has begun
    reg [CONTEXTS-1:0]  next_q, visit_q, awake_q;     // with an object in the next batch; in this; awake
    wire                begins = take_i && begins_i;
    wire                sleeps = valid_i && asleep_i && reported_batch_i == batch_q;
    wire [CONTEXTS-1:0] reported = {{CONTEXTS-1{1'b0}}, 1'b1} << reported_context_i;
    integer             n;
    always @(posedge clk_i) begin
        if (open_i)      left_q <= count_i;
        else if (begins) left_q <= left_q - CONTEXTS_R;
        for (n = 0; n < CONTEXTS; n = n + 1) next_q[n] <= left_q > n[ROW_W:0];
        if (open_i)      batch_q <= 1'b0;
        else if (begins) batch_q <= !batch_q;
        if (begins)      {visit_q, awake_q} <= {next_q, next_q};
        else if (sleeps) awake_q <= awake_q & ~reported;
        skip_q <= !begins && awake_q == {CONTEXTS{1'b0}};
    end
    assign more_o  = more_q;
    assign skip_o  = skip_q && fetch_batch_q == batch_q;
    assign mask_o  = begins_i ? next_q : in_last_i ? visit_q : awake_q;
    assign batch_o = batch_q;

`ifdef FP3_CHECK
    reg fresh_q;                       // since a round has opened, no instruction was taken
    always @(posedge clk_i) begin
        fresh_q <= !rst_i && (open_i || (fresh_q && !take_i));
        if (!rst_i && valid_i && (open_i || fresh_q)) begin
            $display("%m: a report of the round before, or of nothing"); $stop;
        end
        if (!rst_i && sleeps && !(|(visit_q & reported))) begin
            $display("%m: a report about context %0d, which has no object", reported_context_i); $stop;
        end
    end
`else
    wire unused = rst_i;
`endif
endmodule
`default_nettype wire
