// SPDX-License-Identifier: Apache-2.0
// fp3_transact: carries out a request as a master of AXI4-Lite, and keeps its answer.
//
// Purpose   The words of a request go to, or come from, addresses that grow by 4, one transfer
//           after the other, until the bus answers one with an error. The store has those to write,
//           or those that were read.
// Latency   Three cycles for each word, plus the time of the bus.
// Promise   A write with the sequence number of the last write is not executed again: it gets the
//           first answer. After a read, it counts as a new write. An address with more bits than
//           the bus has is answered like an error of the bus.
// Hazard    There is no timeout: a slave that never answers stops the bridge until a reset.
`default_nettype none
module fp3_transact #(
    parameter ADDRESS_W = 24           // bits of a byte address on the bus, < 32
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // The request, while idle_o is high; what comes with it stands until done_i
    output wire                 idle_o,
    input  wire                 request_i,
    input  wire [7:0]           sequence_i,
    input  wire                 write_i,
    input  wire [5:0]           last_i,
    input  wire [31:0]          address_i,
    input  wire                 store_i,
    input  wire [5:0]           store_at_i,
    input  wire [31:0]          store_word_i,
    // The answer
    output wire                 answer_o,
    input  wire                 done_i,
    output wire [7:0]           sequence_o,
    output wire [7:0]           status_o,
    output wire [6:0]           words_o,
    input  wire [5:0]           word_at_i,
    output wire [31:0]          word_o,
    // The bus
    output wire [ADDRESS_W-1:0] m_axi_awaddr,
    output wire [2:0]           m_axi_awprot,
    output wire                 m_axi_awvalid,
    input  wire                 m_axi_awready,
    output wire [31:0]          m_axi_wdata,
    output wire [3:0]           m_axi_wstrb,
    output wire                 m_axi_wvalid,
    input  wire                 m_axi_wready,
    input  wire [1:0]           m_axi_bresp,
    input  wire                 m_axi_bvalid,
    output wire                 m_axi_bready,
    output wire [ADDRESS_W-1:0] m_axi_araddr,
    output wire [2:0]           m_axi_arprot,
    output wire                 m_axi_arvalid,
    input  wire                 m_axi_arready,
    input  wire [31:0]          m_axi_rdata,
    input  wire [1:0]           m_axi_rresp,
    input  wire                 m_axi_rvalid,
    output wire                 m_axi_rready
);
    // FETCH: a word leaves the store, and its address is looked at. WAIT: the bus has the transfer.
    localparam [1:0] IDLE = 2'd0, FETCH = 2'd1, WAIT = 2'd2, ANSWER = 2'd3;

    reg [1:0]  state_q;
    reg        aw_q, w_q, ar_q;        // not taken yet
    reg        kept_q;                 // sequence_q and status_q are those of a write, the last request of all
    reg [7:0]  sequence_q;
    reg [6:0]  status_q;
    reg [31:0] address_q;
    reg [5:0]  word_q;

    wire       again   = kept_q && write_i && sequence_i == sequence_q;
    wire       begins  = state_q == IDLE && request_i && !again;
    wire       outside = |address_q[31:ADDRESS_W];
    wire       goes    = state_q == FETCH && !outside;
    wire       over    = write_i ? m_axi_bvalid : m_axi_rvalid;
    wire       failed  = write_i ? m_axi_bresp[1] : m_axi_rresp[1];
    wire       read    = state_q == WAIT && !write_i && m_axi_rvalid;
    wire [6:0] number  = {1'b0, word_q} + 7'd1;
    reg  [1:0] next;
    always @* begin
        case (state_q)
        IDLE:    next = !request_i ? IDLE : again ? ANSWER : FETCH;
        FETCH:   next = outside ? ANSWER : WAIT;
        WAIT:    next = !over ? WAIT : failed || word_q == last_i ? ANSWER : FETCH;
        default: next = done_i ? IDLE : ANSWER;
        endcase
    end
    always @(posedge clk_i) begin
        if (rst_i) {state_q, aw_q, w_q, ar_q, kept_q} <= {IDLE, 4'b0000};
        else begin
            state_q <= next;
            aw_q    <= aw_q ? !m_axi_awready : goes && write_i;
            w_q     <= w_q  ? !m_axi_wready  : goes && write_i;
            ar_q    <= ar_q ? !m_axi_arready : goes && !write_i;
            if (begins) kept_q <= write_i;
        end
        if (begins) {sequence_q, address_q, word_q, status_q} <= {sequence_i, address_i, 6'd0, 7'd0};
        if (state_q == FETCH && outside || state_q == WAIT && over && failed) status_q <= number;
        if (state_q == WAIT && over) begin
            address_q <= address_q + 32'd4;
            word_q    <= number[5:0];
        end
    end

    // One memory for both directions: a request has words, or its answer has.
    fp3_ram_1r1w #(.ADDR_W(6), .W(32)) u_store (
        .clk_i(clk_i), .write_i(store_i || read), .write_addr_i(store_i ? store_at_i : word_q),
        .write_value_i(store_i ? store_word_i : m_axi_rdata), .read_i(1'b1),
        .read_addr_i(state_q == ANSWER ? word_at_i : word_q), .read_value_o(word_o));

    assign idle_o        = state_q == IDLE;
    assign answer_o      = state_q == ANSWER;
    assign sequence_o    = sequence_q;
    assign status_o      = {1'b0, status_q};
    assign words_o       = write_i ? 7'd0 : status_q != 7'd0 ? status_q - 7'd1 : {1'b0, last_i} + 7'd1;
    assign m_axi_awaddr  = address_q[ADDRESS_W-1:0];
    assign m_axi_araddr  = address_q[ADDRESS_W-1:0];
    assign m_axi_awprot  = 3'b000;
    assign m_axi_arprot  = 3'b000;
    assign m_axi_awvalid = aw_q;
    assign m_axi_wvalid  = w_q;
    assign m_axi_arvalid = ar_q;
    assign m_axi_wdata   = word_o;
    assign m_axi_wstrb   = 4'b1111;
    assign m_axi_bready  = state_q == WAIT && write_i;
    assign m_axi_rready  = state_q == WAIT && !write_i;
    wire unused = &{m_axi_bresp[0], m_axi_rresp[0]};
endmodule
`default_nettype wire
