// SPDX-License-Identifier: Apache-2.0
// fp3_master: a master of AXI4 beside the slave of AXI4-Lite, between axi_lite and hub.
//
// Purpose   Transfers between memory and the processor without a host for each word (transfer). The
//           requests of a transfer go where the host's go, so they reach whatever the host reaches,
//           and are refused where the host's are.
//
//           axi_lite ──┬───────────────► turns ──► hub
//                      └──► transfer ───────┘
//                              ▲ ▼ AXI4
//
// Latency   One from the host's request to the hub, as long as no transfer has its turn: a request
//           stands in a register, so no path leads from the host's bus to memory's. Two from a
//           request for a register of the transfer to its answer; it waits for no turn.
// Promise   As axi_lite, turns and transfer. All transfers of AXI4 have ID 0, 32 bits, INCR.
// Hazard    As hub for requests. A register of the transfer is alone.
`default_nettype none
module fp3_master #(
    parameter ADDRESS_W = 24,
    parameter INSIDE    = 18,          // bits of an address within a scheduler
    parameter [ADDRESS_W-1:0] STREAM = 0,
    parameter READS_W   = 4            // 2^READS_W reads hide the latency of one
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // The host
    input  wire                 host_valid_i,
    output wire                 host_ready_o,
    input  wire                 host_write_i,
    input  wire [ADDRESS_W-1:0] host_addr_i,
    input  wire [31:0]          host_wdata_i,
    output wire                 host_wrote_o,         // a write is answered
    output wire                 host_write_error_o,
    output wire                 host_read_o,          // a read is answered
    output wire                 host_read_error_o,
    output wire [31:0]          host_rdata_o,
    // The hub
    output wire                 req_valid_o,
    input  wire                 req_ready_i,
    output wire                 req_write_o,
    output wire [ADDRESS_W-1:0] req_addr_o,
    output wire [31:0]          req_wdata_o,
    input  wire                 wrote_i,
    input  wire                 write_error_i,
    input  wire                 read_i,
    input  wire                 read_error_i,
    input  wire [31:0]          rdata_i,
    // Memory
    output wire                 m_axi_awid,
    output wire [31:0]          m_axi_awaddr,
    output wire [7:0]           m_axi_awlen,
    output wire [2:0]           m_axi_awsize,
    output wire [1:0]           m_axi_awburst,
    output wire                 m_axi_awlock,
    output wire [3:0]           m_axi_awcache,
    output wire [2:0]           m_axi_awprot,
    output wire                 m_axi_awvalid,
    input  wire                 m_axi_awready,
    output wire [31:0]          m_axi_wdata,
    output wire [3:0]           m_axi_wstrb,
    output wire                 m_axi_wlast,
    output wire                 m_axi_wvalid,
    input  wire                 m_axi_wready,
    input  wire                 m_axi_bid,
    input  wire [1:0]           m_axi_bresp,
    input  wire                 m_axi_bvalid,
    output wire                 m_axi_bready,
    output wire                 m_axi_arid,
    output wire [31:0]          m_axi_araddr,
    output wire [7:0]           m_axi_arlen,
    output wire [2:0]           m_axi_arsize,
    output wire [1:0]           m_axi_arburst,
    output wire                 m_axi_arlock,
    output wire [3:0]           m_axi_arcache,
    output wire [2:0]           m_axi_arprot,
    output wire                 m_axi_arvalid,
    input  wire                 m_axi_arready,
    input  wire                 m_axi_rid,
    input  wire [31:0]          m_axi_rdata,
    input  wire [1:0]           m_axi_rresp,
    input  wire                 m_axi_rlast,
    input  wire                 m_axi_rvalid,
    output wire                 m_axi_rready
);
`include "gen/registers.vh"
    localparam OPEN_W = READS_W + 1;                       // all of the transfer's reads, or the host's and its writes
    localparam [ADDRESS_W-1:0] NOWHERE = 1;                // no multiple of 4
    // The host's request, until it is taken
    reg                 held_q, ours_q, write_q;
    reg [ADDRESS_W-1:0] addr_q;
    reg [31:0]          wdata_q;
    // Registers of the transfer, of whatever scheduler
    wire               ours   = host_addr_i[INSIDE-1:5] == {{INSIDE-16{1'b0}}, ADDR_TRANSFER_MEMORY[15:5]} && host_addr_i[1:0] == 2'd0;
    wire               told, told_write, told_error;
    wire [31:0]        told_rdata;

    wire               hub_host, moves, move_valid, move_ready, move_write, wrote, read, strobe;
    wire [31:2]        place, memory;
    wire [31:0]        move_wdata;
    wire [7:0]         length;
    wire [OPEN_W-1:0]  open;
    wire [31:0]        bytes     = {place, 2'd0};
    wire [ADDRESS_W-1:0] move_addr = |bytes[31:ADDRESS_W] ? NOWHERE : bytes[ADDRESS_W-1:0];
    assign wrote = wrote_i && moves;
    assign read  = read_i && moves;
    fp3_transfer #(.READS_W(READS_W), .OPEN_W(OPEN_W)) u_transfer (.clk_i(clk_i), .rst_i(rst_i),
        .ask_i(held_q && ours_q), .ask_write_i(write_q), .ask_register_i(addr_q[4:2]), .ask_wdata_i(wdata_q),
        .told_o(told), .told_write_o(told_write), .told_error_o(told_error), .told_rdata_o(told_rdata),
        .req_valid_o(move_valid), .req_ready_i(move_ready), .req_write_o(move_write), .req_place_o(place), .req_wdata_o(move_wdata),
        .answered_i(wrote || read), .answer_error_i(wrote ? write_error_i : read_error_i),
        .answer_rdata_i(rdata_i), .open_i(open),
        .awvalid_o(m_axi_awvalid), .awready_i(m_axi_awready), .arvalid_o(m_axi_arvalid), .arready_i(m_axi_arready),
        .address_o(memory), .length_o(length),
        .wvalid_o(m_axi_wvalid), .wready_i(m_axi_wready), .wdata_o(m_axi_wdata), .wstrobe_o(strobe), .wlast_o(m_axi_wlast),
        .bvalid_i(m_axi_bvalid), .bready_o(m_axi_bready), .berror_i(m_axi_bresp[1]),
        .rvalid_i(m_axi_rvalid), .rready_o(m_axi_rready), .rdata_i(m_axi_rdata), .rerror_i(m_axi_rresp[1]));

    fp3_turns #(.W(ADDRESS_W + 32), .OPEN_W(OPEN_W)) u_turns (.clk_i(clk_i), .rst_i(rst_i),
        .host_valid_i(held_q && !ours_q), .host_ready_o(hub_host), .host_write_i(write_q), .host_what_i({addr_q, wdata_q}),
        .move_valid_i(move_valid), .move_ready_o(move_ready), .move_streams_i(|(move_addr & STREAM)), .move_write_i(move_write),
        .move_what_i({move_addr, move_wdata}), .moves_o(moves), .open_o(open),
        .req_valid_o(req_valid_o), .req_ready_i(req_ready_i), .req_write_o(req_write_o),
        .req_what_o({req_addr_o, req_wdata_o}), .wrote_i(wrote_i), .read_i(read_i));
    assign host_ready_o  = !held_q || ours_q || hub_host;
    always @(posedge clk_i) begin
        held_q <= (host_valid_i || !host_ready_o) && !rst_i;
        if (host_ready_o) {ours_q, write_q, addr_q, wdata_q} <= {ours, host_write_i, host_addr_i, host_wdata_i};
    end
    assign host_wrote_o       = (wrote_i && !moves) || (told && told_write);
    assign host_write_error_o = told ? told_error : write_error_i;
    assign host_read_o        = (read_i && !moves) || (told && !told_write);
    assign host_read_error_o  = told ? told_error : read_error_i;
    assign host_rdata_o       = told ? told_rdata : rdata_i;

    localparam [2:0] WORD = 3'd2;
    localparam [1:0] INCR = 2'd1;
    localparam [3:0] BUFFERED = 4'b0011;                   // normal memory, not cached, bufferable
    assign {m_axi_awid, m_axi_arid, m_axi_awlock, m_axi_arlock} = 4'd0;
    assign {m_axi_awprot, m_axi_arprot}   = 6'd0;
    assign {m_axi_awaddr, m_axi_araddr}   = {2{memory, 2'd0}};
    assign {m_axi_awlen, m_axi_arlen}     = {2{length}};
    assign {m_axi_awsize, m_axi_arsize}   = {2{WORD}};
    assign {m_axi_awburst, m_axi_arburst} = {2{INCR}};
    assign {m_axi_awcache, m_axi_arcache} = {2{BUFFERED}};
    assign m_axi_wstrb = {4{strobe}};
    wire unused = &{m_axi_bid, m_axi_rid, m_axi_rlast, m_axi_bresp[0], m_axi_rresp[0]};
endmodule
`default_nettype wire
