// dual_lane: a lane that adds and multiplies at once: its registers in two banks, the store behind them, and
// what becomes of each result.
//
// Purpose   Does what its sequencer says: in each cycle a sum for one context and a product for another. Sums are
//           written to one bank, products to the other; every operation reads at most one register of each, so
//           that four memories with one read and one write port are enough and no operand is chosen.
//
//           cycle    0           1, 2         3           .. W = LATENCY+2            W+1
//           issue    operands    registers    operands    arithmetic, results         written, retired
//                    named       read         registered
//                    A sum's y was named two cycles before: its word waits a cycle, and is scaled in two.
//           retire               named in W-4, the store's word there in W-1
//
// Latency   A register that is named GAP cycles after the issue of the instruction that writes it, or
//           later, has the new value.
// Hazard    Nothing is interlocked here: one context does not come twice within GAP cycles (checked in
//           dual_sequencer). The host's accesses come when no instruction is in the lane.
`default_nettype none
`include "lane/dual_issue.vh"
`include "lane/dual_retire.vh"
`include "lane/access.vh"
`include "lane/report.vh"
module dual_lane #(
`include "config/config.vh"
) (
    input  wire                      clk_i,
    input  wire                      rst_i,
    input  wire [LANE_W-1:0]         index_i,        // this lane's number; does not change
    // What the sequencer and the host say
    input  wire [`DUAL_ISSUE_W-1:0]  issue_i,
    input  wire [`DUAL_RETIRE_W-1:0] retire_i,
    input  wire [`ACCESS_W-1:0]      access_i,
    input  wire [31:0]               data_i,         // of an access: its word
    // What they hear, gathered from lane to lane
    input  wire [`REPORT_W-1:0]      report_i,
    output wire [`REPORT_W-1:0]      report_o,
    // Trace, as in lane: of sums, and of products
    output wire [3:0]              written_end_o,
    output wire [1:0]              written_o,
    output wire [2*CONTEXT_W-1:0]  written_context_o,
    output wire [2*ROW_W-1:0]      written_row_o,
    output wire [2*REGISTER_W-1:0] written_register_o,
    output wire [63:0]             written_value_o,
    output wire [9:0]              written_flags_o
);
`include "host/lane_host.vh"

    `DUAL_ISSUE_FIELDS
    `DUAL_RETIRE_FIELDS
    `ACCESS_FIELDS
    `REPORT_FIELDS
    assign `DUAL_ISSUE  = issue_i;      // cycle 0
    assign `DUAL_RETIRE = retire_i;     // cycle W-4
    assign `ACCESS      = access_i;
    wire mine  = access_valid && access_lane == index_i;
    wire write = mine && access_write;

    // How many objects: those of the rows below
    reg [ROW_W:0] count_q;
    always @(posedge clk_i)
        if (rst_i)                                    count_q <= {ROW_W+1{1'b0}};
        else if (write && access_space == HOST_AWAKE) count_q <= data_i[ROW_W:0];

    // The ends of the instructions, later ----------------------------------------------------------------
    wire sum_valid_w0, adds_w0, sum_loads_w0, product_valid_w0, product_loads_w0, sum_there_w0, product_there_w0, loads_w1;
    wire sum_there_w4     = {1'b0, retire_sum_row} < count_q;
    wire product_there_w4 = {1'b0, retire_product_row} < count_q;
    wire [REG_W-1:0] sum_register_w0, product_register_w0;
    delay #(.W(5), .N(4)) u_ends (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({retire_sum_valid, retire_sum_adds, retire_sum_loads, retire_product_valid, retire_product_loads}),
        .q_o({sum_valid_w0, adds_w0, sum_loads_w0, product_valid_w0, product_loads_w0}));
    delay #(.W(2), .N(4)) u_there (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_there_w4, product_there_w4}), .q_o({sum_there_w0, product_there_w0}));
    delay #(.W(1), .N(3)) u_loads (.clk_i(clk_i), .rst_i(1'b0), .d_i(retire_sum_loads || retire_product_loads), .q_o(loads_w1));
    delay #(.W(2*REG_W), .N(4)) u_registers (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({retire_sum_context, retire_sum_register, retire_product_context, retire_product_register}),
        .q_o({sum_register_w0, product_register_w0}));

    // Operands -------------------------------------------------------------------------------------------
    reg               sum_write_q, product_write_q;                 // W+1
    reg  [BANK_W-1:0] sum_spot_q, product_spot_q;
    reg  [31:0]       sum_value_q, product_value_q;
    wire [31:0]       sum_x, product_x, product_y;                  // cycle 2
    wire [31:0]       sum_y_read;                                   // cycle 0
    reg  [31:0]       sum_y_q;
    always @(posedge clk_i) sum_y_q <= sum_y_read;
    ram_registered #(.ADDR_W(BANK_W)) u_sum_x (.clk_i(clk_i), .write_i(sum_write_q && !rst_i),
        .write_addr_i(sum_spot_q), .write_value_i(sum_value_q),
        .read_i(1'b1), .read_addr_i(issue_sum_x), .read_value_o(sum_x));
    ram_registered #(.ADDR_W(BANK_W)) u_sum_y (.clk_i(clk_i), .write_i(product_write_q && !rst_i),
        .write_addr_i(product_spot_q), .write_value_i(product_value_q),
        .read_i(1'b1), .read_addr_i(issue_sum_y), .read_value_o(sum_y_read));
    ram_registered #(.ADDR_W(BANK_W)) u_product_x (.clk_i(clk_i), .write_i(sum_write_q && !rst_i),
        .write_addr_i(sum_spot_q), .write_value_i(sum_value_q),
        .read_i(1'b1), .read_addr_i(issue_product_x), .read_value_o(product_x));
    ram_registered #(.ADDR_W(BANK_W)) u_product_y (.clk_i(clk_i), .write_i(product_write_q && !rst_i),
        .write_addr_i(product_spot_q), .write_value_i(product_value_q),
        .read_i(1'b1), .read_addr_i(issue_product_y), .read_value_o(product_y));

    wire        minus_x_i2, minus_y_i2, twice_i1, half_i1, st_x_i2, st_y_i2;
    wire [31:0] stored;                                             // cycle 3
    wire [31:0] sum, product;                                       // W
    wire [4:0]  sum_flags, product_flags;
    delay #(.W(2), .N(1)) u_scale (.clk_i(clk_i), .rst_i(1'b0), .d_i({issue_twice, issue_half}), .q_o({twice_i1, half_i1}));
    delay #(.W(4), .N(2)) u_force (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({issue_minus_x, issue_minus_y, issue_st && !issue_st_y, issue_st && issue_st_y}),
        .q_o({minus_x_i2, minus_y_i2, st_x_i2, st_y_i2}));
    dual_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i),
        .minus_x_i(minus_x_i2), .minus_y_i(minus_y_i2), .twice_i(twice_i1), .half_i(half_i1),
        .no_x_i(st_y_i2), .no_y_i(st_x_i2),
        .sum_x_i(sum_x), .sum_y_i(sum_y_q), .product_x_i(product_x), .product_y_i(product_y),
        .stored_o(stored), .sum_o(sum), .sum_flags_o(sum_flags), .product_o(product), .product_flags_o(product_flags));

    // The store ------------------------------------------------------------------------------------------
    wire [31:0] word_w1;
    lane_store #(.CONFIG(CONFIG)) u_store (.clk_i(clk_i), .rst_i(rst_i), .record_i(issue_record),
        .st_i(issue_st), .lasts_i(1'b1), .register_i(issue_register),
        .row_i2_i(issue_st_row), .absent_i2_i({1'b0, issue_st_row} >= count_q), .asleep_i2_i(1'b0), .value_i3_i(stored),
        .row_w3_i(retire_load_row), .register_w3_i(retire_load_register), .word_o(word_w1),
        .host_i(access_valid), .host_write_i(write && access_space == HOST_OBJECT), .host_address_i(access_address),
        .host_word_i(data_i));

    // Results: written in W+1 ------------------------------------------------------------------------------
    reg              constant_q;                // the host's
    reg [BANK_W-1:0] constant_spot_q;
    reg [31:0]       other_q;                   // W: no result
    wire             sum_writes     = sum_there_w0 && (adds_w0 || sum_loads_w0);
    wire             product_writes = product_there_w0 && product_valid_w0;
    wire             sum_raises     = FLAGS != 0 && sum_there_w0 && adds_w0;
    wire             product_raises = FLAGS != 0 && product_writes && !product_loads_w0;
    reg  [3:0]       end_q;
    reg  [1:0]       retired_q, raises_q;
    reg  [9:0]       value_flags_q;
    always @(posedge clk_i) begin
        constant_q      <= !rst_i && access_valid && access_write && access_space == HOST_CONSTANT;     // of all lanes
        constant_spot_q <= {{CONTEXT_W-1{1'b1}}, access_address[REGISTER_W-1:0]};
        other_q         <= loads_w1 ? word_w1 : data_i;
        sum_write_q     <= !rst_i && (sum_writes || constant_q);
        product_write_q <= !rst_i && (product_writes || constant_q);
        sum_spot_q      <= constant_q ? constant_spot_q : sum_register_w0[REG_W-1:1];
        sum_value_q     <= adds_w0 ? sum : other_q;
        product_spot_q  <= constant_q ? constant_spot_q : product_register_w0[REG_W-1:1];
        product_value_q <= product_loads_w0 || constant_q ? other_q : product;
    end
    always @(posedge clk_i) begin
        end_q         <= {!rst_i && product_valid_w0 ? {product_there_w0, 1'b1} : 2'd0, !rst_i && sum_valid_w0 ? {sum_there_w0, 1'b1} : 2'd0};
        retired_q     <= {product_writes, sum_writes} & {2{!rst_i}};
        raises_q      <= {product_raises, sum_raises} & {2{!rst_i}};
        value_flags_q <= {product_flags, sum_flags};
    end
    wire [9:0] flags = value_flags_q & {{5{raises_q[1]}}, {5{raises_q[0]}}};

    // What the sequencer and the host hear -----------------------------------------------------------------
    lane_report #(.CONFIG(CONFIG)) u_report (.clk_i(clk_i), .rst_i(rst_i), .report_i(report_i),
        .count_i(count_q), .flags_i(flags[9:5] | flags[4:0]), .asleep_i(1'b0),
        .valid_i(1'b0), .batch_i(1'b0), .context_i({CONTEXT_W{1'b0}}),
        .mine_i(mine), .space_i(access_space), .stored_i(word_w1), .status_i(32'd0),
        .count_o(report_count), .flags_o(report_flags), .answer_o(report_answer), .valid_o(report_valid),
        .asleep_o(report_asleep), .batch_o(report_batch), .context_o(report_context));
    assign report_o = `REPORT;

    // Trace
    wire [REG_W-1:0] sum_register_q, product_register_q;
    delay #(.W(2*REG_W), .N(1)) u_shown (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({product_register_w0, sum_register_w0}), .q_o({product_register_q, sum_register_q}));
    delay #(.W(2*ROW_W), .N(5)) u_rows (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({retire_product_row, retire_sum_row}), .q_o(written_row_o));
    assign written_end_o      = end_q;
    assign written_o          = retired_q;
    assign written_context_o  = {product_register_q[REG_W-1:REGISTER_W], sum_register_q[REG_W-1:REGISTER_W]};
    assign written_register_o = {product_register_q[REGISTER_W-1:0], sum_register_q[REGISTER_W-1:0]};
    assign written_value_o    = {product_value_q, sum_value_q};
    assign written_flags_o    = flags;
endmodule
`default_nettype wire
