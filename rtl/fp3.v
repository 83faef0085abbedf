// SPDX-License-Identifier: Apache-2.0
// fp3: the field-programmable physics processor.
//
// Purpose   Integrates equations of motion. A host loads a program and objects over an AXI4-Lite
//           bus and starts a run of N steps; docs/architecture.md says how the parts work together.
//
//           bus ──► axi_lite ──► hub ──► solo                     one object, STORE_WORDS = 0
//                            ▲    └────► tile, tile ...           many, STORE_WORDS > 0
//           memory ◄──► master                                    MASTER = 1
//
// Latency   See solo, or sequencer and lane; axi_lite, hub and host_port for an access of the host.
// Trace     Its ports (issue_*, retire_*) are for simulation; leave them open in a design, as a
//           top does without FP3_TRACE. They have a part for each scheduler, or for each lane of
//           each, the first in the low bits.
// Use       A named configuration (`make top CONFIG=name`), or set parameters by name.
//           Below fp3 only CONFIG is handed on, all of them in one: rtl/config/config.vh.
`default_nettype none
`include "host/answer.vh"
`include "lane/bundles.vh"
`include "sequence/issued.vh"
module fp3 #(
`include "gen/parameters.vh"
,
// verilator lint_off UNUSEDPARAM
`include "config/derived.vh"
// verilator lint_on UNUSEDPARAM
) (
    // The bus: AXI4-Lite. The attributes say what Vivado cannot tell from a port's name; each top
    // has them, too.
    (* X_INTERFACE_INFO = "xilinx.com:signal:clock:1.0 s_axi_aclk CLK" *)
    (* X_INTERFACE_PARAMETER = "XIL_INTERFACENAME s_axi_aclk, ASSOCIATED_BUSIF s_axi, ASSOCIATED_RESET s_axi_aresetn" *)
    input  wire                 s_axi_aclk,
    (* X_INTERFACE_INFO = "xilinx.com:signal:reset:1.0 s_axi_aresetn RST" *)
    (* X_INTERFACE_PARAMETER = "XIL_INTERFACENAME s_axi_aresetn, POLARITY ACTIVE_LOW" *)
    input  wire                 s_axi_aresetn,
    input  wire [ADDRESS_W-1:0] s_axi_awaddr,
    input  wire [2:0]           s_axi_awprot,
    input  wire                 s_axi_awvalid,
    output wire                 s_axi_awready,
    input  wire [31:0]          s_axi_wdata,
    input  wire [3:0]           s_axi_wstrb,
    input  wire                 s_axi_wvalid,
    output wire                 s_axi_wready,
    output wire [1:0]           s_axi_bresp,
    output wire                 s_axi_bvalid,
    input  wire                 s_axi_bready,
    input  wire [ADDRESS_W-1:0] s_axi_araddr,
    input  wire [2:0]           s_axi_arprot,
    input  wire                 s_axi_arvalid,
    output wire                 s_axi_arready,
    output wire [31:0]          s_axi_rdata,
    output wire [1:0]           s_axi_rresp,
    output wire                 s_axi_rvalid,
    input  wire                 s_axi_rready,
    // With `master`: memory, AXI4. A top without it has none of these.
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
    output wire                 m_axi_rready,
    // High while a scheduler's run has ended and its register `interrupt` says so
    (* X_INTERFACE_INFO = "xilinx.com:signal:interrupt:1.0 irq INTERRUPT" *)
    (* X_INTERFACE_PARAMETER = "XIL_INTERFACENAME irq, SENSITIVITY LEVEL_HIGH" *)
    output wire                 irq,
    // Trace: instructions issue
    output wire [TILES*SCHEDULERS*(DUAL+1)-1:0]          issue_valid_o,
    output wire [16*TILES*SCHEDULERS*(DUAL+1)-1:0]       issue_pc_o,
    output wire [16*TILES*SCHEDULERS*(DUAL+1)-1:0]       issue_context_o,
    output wire [32*TILES*SCHEDULERS*(DUAL+1)-1:0]       issue_word_o,
    // Trace: an instruction ends (0: none; 1: the context has no object; 2: it sleeps; 3: executed)
    // and its result is written
    output wire [2*TILES*SCHEDULERS*LANES*(DUAL+1)-1:0]  retire_end_o,
    output wire [TILES*SCHEDULERS*LANES*(DUAL+1)-1:0]    retire_valid_o,
    output wire [16*TILES*SCHEDULERS*LANES*(DUAL+1)-1:0] retire_context_o,
    output wire [32*TILES*SCHEDULERS*LANES*(DUAL+1)-1:0] retire_object_o,
    output wire [6*TILES*SCHEDULERS*LANES*(DUAL+1)-1:0]  retire_register_o,
    output wire [32*TILES*SCHEDULERS*LANES*(DUAL+1)-1:0] retire_value_o,
    output wire [5*TILES*SCHEDULERS*LANES*(DUAL+1)-1:0]  retire_flags_o
);
`include "gen/registers.vh"
    localparam N = TILES * SCHEDULERS;
    fp3_config_rules #(.CONFIG(CONFIG), .FOLLOW(FOLLOW)) u_rules ();

    // Reset is registered, and passes from group to group of the lanes. It lasts until it has
    // passed the last group, whose reports would still be old; until then the bus accepts nothing.
    // At power-up everything is in reset.
    wire             clk = s_axi_aclk, bus_rst = !s_axi_aresetn;
    localparam integer RESET = GROUPS + TIMING_RESET;
    reg [RESET-1:0]  reset_q;
    initial          reset_q = {RESET{1'b1}};
    wire             rst = reset_q[0];
    reg              irq_q;
    always @(posedge clk) reset_q <= bus_rst ? {RESET{1'b1}} : reset_q >> 1;

    // All of the spaces above 0 streams; only the list of copies has the lower bit alone.
    localparam integer    INSIDE = SPACE_BIT + ADDRESS_SPACE_BITS;       // bits of an address within a scheduler
    localparam [31:0]     STREAM = {16'd0, ADDRESS_STREAM} | ((EXCHANGE != 0 ? 32'd3 : 32'd2) << SPACE_BIT);
    // Enough requests may be under way to fill the path to the lanes and back; with one object,
    // few.
    localparam WRITES_W = STORE_WORDS != 0 ? 4 : 2;
    localparam READS_W  = STORE_WORDS != 0 ? $clog2(MEMORY_LATENCY + TIMING_BUS) : 2;
    wire                 asks, taken, write, host_asks, host_taken, host_write;
    wire [ADDRESS_W-1:0] address, host_address;
    wire [31:0]          wdata, host_wdata;
    wire                 host_wrote, host_write_error, host_read, host_read_error;
    wire [31:0]          host_rdata;
    `FP3_ANSWER_FIELDS
    fp3_axi_lite #(.ADDRESS_W(ADDRESS_W), .STREAM(STREAM[ADDRESS_W-1:0]), .WRITES_W(WRITES_W),
        .READS_W(READS_W)) u_axi (
        .clk_i(clk), .rst_i(bus_rst),
        .s_axi_awvalid(s_axi_awvalid), .s_axi_awready(s_axi_awready), .s_axi_awaddr(s_axi_awaddr),
        .s_axi_wvalid(s_axi_wvalid), .s_axi_wready(s_axi_wready), .s_axi_wdata(s_axi_wdata), .s_axi_wstrb(s_axi_wstrb),
        .s_axi_bvalid(s_axi_bvalid), .s_axi_bready(s_axi_bready), .s_axi_bresp(s_axi_bresp),
        .s_axi_arvalid(s_axi_arvalid), .s_axi_arready(s_axi_arready), .s_axi_araddr(s_axi_araddr),
        .s_axi_rvalid(s_axi_rvalid), .s_axi_rready(s_axi_rready), .s_axi_rdata(s_axi_rdata), .s_axi_rresp(s_axi_rresp),
        .req_valid_o(host_asks), .req_ready_i(host_taken), .req_write_o(host_write), .req_addr_o(host_address),
        .req_wdata_o(host_wdata),
        .wrote_i(host_wrote), .write_error_i(host_write_error),
        .read_i(host_read), .read_error_i(host_read_error), .rdata_i(host_rdata));

    // A transfer asks where the host does. With OVERLAP a request for a word of a store waits while an
    // instruction will have the port.
    wire [N-1:0]         loads, stores;
    wire                 waits = OVERLAP != 0 && address[SPACE_BIT+1] && |(write ? stores : loads);
    generate
        if (MASTER != 0) begin : g_master
            fp3_master #(.ADDRESS_W(ADDRESS_W), .INSIDE(INSIDE), .STREAM(STREAM[ADDRESS_W-1:0]), .READS_W(READS_W + 1)) u_master (
                .clk_i(clk), .rst_i(bus_rst),
                .host_valid_i(host_asks), .host_ready_o(host_taken), .host_write_i(host_write), .host_addr_i(host_address),
                .host_wdata_i(host_wdata), .host_wrote_o(host_wrote), .host_write_error_o(host_write_error),
                .host_read_o(host_read), .host_read_error_o(host_read_error), .host_rdata_o(host_rdata),
                .req_valid_o(asks), .req_ready_i(taken && !waits), .req_write_o(write), .req_addr_o(address), .req_wdata_o(wdata),
                .wrote_i(answer_wrote), .write_error_i(answer_write_error),
                .read_i(answer_read), .read_error_i(answer_read_error), .rdata_i(answer_rdata),
                .m_axi_awid(m_axi_awid), .m_axi_awaddr(m_axi_awaddr), .m_axi_awlen(m_axi_awlen), .m_axi_awsize(m_axi_awsize),
                .m_axi_awburst(m_axi_awburst), .m_axi_awlock(m_axi_awlock), .m_axi_awcache(m_axi_awcache),
                .m_axi_awprot(m_axi_awprot), .m_axi_awvalid(m_axi_awvalid), .m_axi_awready(m_axi_awready),
                .m_axi_wdata(m_axi_wdata), .m_axi_wstrb(m_axi_wstrb), .m_axi_wlast(m_axi_wlast), .m_axi_wvalid(m_axi_wvalid),
                .m_axi_wready(m_axi_wready), .m_axi_bid(m_axi_bid), .m_axi_bresp(m_axi_bresp), .m_axi_bvalid(m_axi_bvalid),
                .m_axi_bready(m_axi_bready),
                .m_axi_arid(m_axi_arid), .m_axi_araddr(m_axi_araddr), .m_axi_arlen(m_axi_arlen), .m_axi_arsize(m_axi_arsize),
                .m_axi_arburst(m_axi_arburst), .m_axi_arlock(m_axi_arlock), .m_axi_arcache(m_axi_arcache),
                .m_axi_arprot(m_axi_arprot), .m_axi_arvalid(m_axi_arvalid), .m_axi_arready(m_axi_arready),
                .m_axi_rid(m_axi_rid), .m_axi_rdata(m_axi_rdata), .m_axi_rresp(m_axi_rresp), .m_axi_rlast(m_axi_rlast),
                .m_axi_rvalid(m_axi_rvalid), .m_axi_rready(m_axi_rready));
        end else begin : g_no_master
            assign {asks, host_taken, write, address, wdata} = {host_asks, taken, host_write, host_address, host_wdata};
            assign {host_wrote, host_write_error, host_read, host_read_error, host_rdata} = `FP3_ANSWER;
            assign {m_axi_awid, m_axi_awaddr, m_axi_awlen, m_axi_awsize, m_axi_awburst, m_axi_awlock, m_axi_awcache, m_axi_awprot,
                    m_axi_awvalid, m_axi_wdata, m_axi_wstrb, m_axi_wlast, m_axi_wvalid, m_axi_bready} = 94'd0;
            assign {m_axi_arid, m_axi_araddr, m_axi_arlen, m_axi_arsize, m_axi_arburst, m_axi_arlock, m_axi_arcache, m_axi_arprot,
                    m_axi_arvalid, m_axi_rready} = 56'd0;
            wire unused_memory = &{m_axi_awready, m_axi_wready, m_axi_bid, m_axi_bresp, m_axi_bvalid, m_axi_arready, m_axi_rid,
                                   m_axi_rdata, m_axi_rresp, m_axi_rlast, m_axi_rvalid};
        end
    endgenerate

    wire [7:0] scheduler;              // all ones, in as many bits as there are: all of them
    generate
        if (N == 1) begin : g_only
            assign scheduler = 8'd0;
        end else begin : g_which
            assign scheduler = &address[ADDRESS_W-1:INSIDE] ? 8'hff : {{8+INSIDE-ADDRESS_W{1'b0}}, address[ADDRESS_W-1:INSIDE]};
        end
    endgenerate
    wire [N-1:0]           req_valid, ended;
    wire                   req_write;
    wire [23:0]            req_addr;
    wire [31:0]            req_wdata;
    wire [`FP3_ANSWER_W*N-1:0] answers;
    // From a number that is added to a list until all lanes have reported the list's count: an
    // access takes MEMORY_LATENCY, and a count passes from lane to lane, one cycle each. With one
    // lane of 32 bits the bus itself takes longer.
    localparam QUIET = SLEEP != 0 && (LANES > 1 || STORAGE != 0) ? MEMORY_LATENCY + LANES : 0;
    fp3_hub #(.N(N), .QUIET(QUIET), .STREAM(STREAM)) u_hub (
        .clk_i(clk), .rst_i(rst),
        .req_valid_i(asks && !waits), .req_ready_o(taken), .req_write_i(write),
        .req_addr_i({scheduler, 24'd0} | {{32-INSIDE{1'b0}}, address[INSIDE-1:0]}), .req_wdata_i(wdata),
        .answer_o(`FP3_ANSWER), .req_valid_o(req_valid), .req_write_o(req_write), .req_addr_o(req_addr),
        .req_wdata_o(req_wdata), .answer_i(answers), .irq_i(ended));
    always @(posedge clk) irq_q <= |ended && !rst;
    assign irq = irq_q;
    wire unused = &{s_axi_awprot, s_axi_arprot};

    // What has no width in one of these breaks a rule, too. Tools that met it first would end
    // before they name the rule (Verilator: with an internal error).
    genvar t;
    generate
        if (INTERLEAVE == 0) begin : g_one
            assign {issue_context_o, retire_context_o, retire_object_o} = 64'd0;
            assign {loads, stores} = 2'b00;
            assign retire_end_o = {2{retire_valid_o}};
            fp3_solo #(.CONFIG(CONFIG)) u_solo (
                .clk_i(clk), .rst_i(rst),
                .req_valid_i(req_valid[0]), .req_write_i(req_write), .req_addr_i(req_addr), .req_wdata_i(req_wdata),
                .answer_o(answers), .irq_o(ended[0]),
                .issue_valid_o(issue_valid_o), .issue_pc_o(issue_pc_o), .issue_word_o(issue_word_o),
                .retire_valid_o(retire_valid_o), .retire_register_o(retire_register_o),
                .retire_value_o(retire_value_o), .retire_flags_o(retire_flags_o));
        end else if (LANES > 0 && CONTEXTS > 0 && REGISTERS > 1 && STORE_WORDS >= 16) begin : g_many
            localparam S = SCHEDULERS, I = S * (DUAL + 1), L = I * LANES;
            wire [`FP3_ISSUED_W*TILES*I-1:0]  issued;
            wire [`FP3_WRITTEN_W*TILES*L-1:0] written;
            for (t = 0; t < TILES; t = t + 1) begin : g_tile
                fp3_tile #(.CONFIG(CONFIG)) u_tile (
                    .clk_i(clk), .rst_i(rst),
                    .req_valid_i(req_valid[S*t +: S]), .req_write_i(req_write), .req_addr_i(req_addr),
                    .req_wdata_i(req_wdata),
                    .answer_o(answers[`FP3_ANSWER_W*S*t +: `FP3_ANSWER_W*S]), .irq_o(ended[S*t +: S]),
                    .loads_o(loads[S*t +: S]), .stores_o(stores[S*t +: S]),
                    .issued_o(issued[`FP3_ISSUED_W*I*t +: `FP3_ISSUED_W*I]),
                    .written_o(written[`FP3_WRITTEN_W*L*t +: `FP3_WRITTEN_W*L]));
            end
            for (t = 0; t < TILES * I; t = t + 1) begin : g_issue
                `FP3_ISSUED_FIELDS
                assign `FP3_ISSUED = issued[`FP3_ISSUED_W*t +: `FP3_ISSUED_W];
                assign issue_valid_o[t]            = issued_valid;
                assign issue_pc_o[16*t +: 16]      = issued_pc;
                assign issue_context_o[16*t +: 16] = issued_context;
                assign issue_word_o[32*t +: 32]    = issued_word;
            end
            for (t = 0; t < TILES * L; t = t + 1) begin : g_retire
                `FP3_WRITTEN_FIELDS
                assign `FP3_WRITTEN = written[`FP3_WRITTEN_W*t +: `FP3_WRITTEN_W];
                assign retire_end_o[2*t +: 2]       = written_end;
                assign retire_valid_o[t]            = written_valid;
                assign retire_context_o[16*t +: 16] = written_context;
                assign retire_object_o[32*t +: 32]  = written_object;
                assign retire_register_o[6*t +: 6]  = written_register;
                assign retire_value_o[32*t +: 32]   = written_value;
                assign retire_flags_o[5*t +: 5]     = written_flags;
            end
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
