// hub_spec: the promises of fp3_hub.v, for every request in any cycle, and schedulers that answer when they like.
`default_nettype none
`include "host/answer.vh"
module hub_spec #(
    parameter N      = 1,
    parameter QUIET  = 0,
    parameter [31:0] STREAM = 32'h20000,
    parameter LEMMAS = 1
) (
    input wire         clk_i,
    input wire         rst_i,
    input wire         req_valid_i, req_write_i,
    input wire [31:0]  req_addr_i, req_wdata_i,
    input wire [`FP3_ANSWER_W*N-1:0] answer_i,
    input wire [N-1:0] irq_i
);
`include "gen/registers.vh"
    localparam W = QUIET == 0 ? 1 : $clog2(QUIET + 1);
    localparam [W-1:0] QUIET_R = QUIET;
    wire                     ready, write;
    wire [N-1:0]             valid;
    wire [23:0]              addr;
    wire [31:0]              wdata;
    wire [`FP3_ANSWER_W-1:0] answer;
    `FP3_ANSWER_FIELDS
    assign `FP3_ANSWER = answer;
    fp3_hub #(.N(N), .QUIET(QUIET), .STREAM(STREAM)) u_hub (.clk_i(clk_i), .rst_i(rst_i),
        .req_valid_i(req_valid_i), .req_ready_o(ready), .req_write_i(req_write_i), .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
        .answer_o(answer), .req_valid_o(valid), .req_write_o(write), .req_addr_o(addr), .req_wdata_o(wdata),
        .answer_i(answer_i), .irq_i(irq_i));

    // Who is asked: a scheduler, all, or if there is none of this number the first one, for what nothing has
    wire [7:0]   who     = req_addr_i[31:24];
    wire         all     = who == ADDRESS_BROADCAST, nobody = !all && who >= N;
    wire [N-1:0] one     = 1;
    wire [N-1:0] whom    = all ? {N{1'b1}} : nobody ? one : one << who;
    wire         streams = |(req_addr_i & STREAM);
    wire         taken   = req_valid_i && ready;

    // The last request, the cycle before, and the time since the last write that streams
    reg          started_q = 1'b0, settled_q = 1'b0;                 // settled: an answer is a register behind its address
    reg          any_q, asks_q, write_q, nobody_q, pends_q, high_q;
    reg [N-1:0]  whom_q;
    reg [23:0]   addr_q;
    reg [31:0]   wdata_q, rdata_q;
    reg [3:0]    kinds_q;
    reg [W-1:0]  since_q;
    reg [31:0]   rdata;
    reg [3:0]    kinds;
    wire [63:0]  irqs = irq_i;
    integer      k;
    always @* begin
        rdata = pends_q ? (high_q ? irqs[63:32] : irqs[31:0]) : 32'd0;
        kinds = 4'd0;
        for (k = 0; k < N; k = k + 1) {kinds, rdata} = {kinds, rdata} | answer_i[`FP3_ANSWER_W*k +: `FP3_ANSWER_W];
    end
    always @(posedge clk_i) begin
        {started_q, settled_q} <= {1'b1, started_q};
        {rdata_q, kinds_q}   <= {rdata, kinds};
        asks_q <= taken && !rst_i;
        any_q  <= !rst_i && (any_q || taken);
        if (rst_i)                                    since_q <= QUIET_R;
        else if (taken && req_write_i && streams)     since_q <= {W{1'b0}};
        else if (since_q != QUIET_R)                  since_q <= since_q + 1'b1;
        if (taken) {whom_q, write_q, addr_q, wdata_q, nobody_q} <= {whom, req_write_i, req_addr_i[23:0], req_wdata_i, nobody};
        if (rst_i)      pends_q <= 1'b0;
        else if (taken) pends_q <= !nobody && (req_addr_i[23:0] >> 3) == ADDR_PENDING >> 3;
        if (taken)      high_q  <= req_addr_i[2];
    end

    always @* assume (started_q || rst_i);
    always @* if (started_q) begin
        // Each request that is taken is asked once, in the next cycle, of whom it names; its address and data stand
        assert (valid == (asks_q ? whom_q : {N{1'b0}}));
        if (any_q) assert (write == write_q && wdata == wdata_q && (nobody_q ? addr[1:0] != 2'd0 : addr == addr_q));
        // What streams waits for nothing; anything else until all have heard of the last such write; nothing is taken in reset
        assert (ready == (!rst_i && (streams || since_q == QUIET_R)));
        // Every answer, in the next cycle, and no other one
        assert ({answer_wrote, answer_read} == (rst_i ? 2'd0 : {kinds_q[3], kinds_q[1]}));
        if (answer_wrote) assert (answer_write_error == kinds_q[2]);
        if (answer_read && settled_q) assert (answer_read_error == kinds_q[0] && answer_rdata == rdata_q);
    end

    (* hierconn *) wire         \u_hub.pending_q ;
    (* hierconn *) wire [W-1:0] \u_hub.g_quiet.left_q ;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (\u_hub.pending_q == pends_q);
                if (pends_q) assert (any_q && !nobody_q && addr_q[2] == high_q);
            end
        end
        if (LEMMAS != 0 && QUIET != 0) begin : g_lemma
            always @* if (started_q) assert (since_q <= QUIET_R && \u_hub.g_quiet.left_q == QUIET_R - since_q);
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
