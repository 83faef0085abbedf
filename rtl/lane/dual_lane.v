// dual_lane: a lane that adds and multiplies at once: its registers, the store behind them, and what becomes of each
// result.
//
// Purpose   Does what its sequencer says: in each cycle a sum for one context and a product for another.
//
//           cycle    0           1, 2         3           .. W = 3 + UNIT_LATENCY     W+1
//           issue    operands    registers    operands    arithmetic, results         written, retired
//                    named       read         to it
//           retire               named in W-4, the store's word there in W-1
//
// Latency   A register that is named GAP cycles after the issue of the instruction that writes it, or
//           later, has the new value.
// Hazard    Nothing is interlocked here: one context does not come twice within GAP cycles (checked in
//           two_streams). The host's accesses come when no instruction is in the lane.
`default_nettype none
`include "lane/lane.vh"
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
    // The arithmetic and the trace: of sums, and of products in the high bits
    output wire [2*`OPERANDS_W-1:0]  operands_o,
    input  wire [2*`RESULT_W-1:0]    result_i,
    output wire [2*`WRITTEN_W-1:0]   written_o
);
`include "host/lane_host.vh"

    `DUAL_ISSUE_FIELDS
    `DUAL_RETIRE_FIELDS
    `ACCESS_FIELDS
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
    delay #(.W(5), .N(TIMING_DUAL_END)) u_ends (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({retire_sum_valid, retire_sum_adds, retire_sum_loads, retire_product_valid, retire_product_loads}),
        .q_o({sum_valid_w0, adds_w0, sum_loads_w0, product_valid_w0, product_loads_w0}));
    delay #(.W(2), .N(TIMING_DUAL_END)) u_there (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_there_w4, product_there_w4}), .q_o({sum_there_w0, product_there_w0}));
    delay #(.W(1), .N(TIMING_DUAL_END-1)) u_loads (.clk_i(clk_i), .rst_i(1'b0), .d_i(retire_sum_loads || retire_product_loads), .q_o(loads_w1));
    delay #(.W(2*REG_W), .N(TIMING_DUAL_END)) u_registers (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({retire_sum_context, retire_sum_register, retire_product_context, retire_product_register}),
        .q_o({sum_register_w0, product_register_w0}));

    // Operands -------------------------------------------------------------------------------------------
    wire             sum_write, product_write;                      // W+1
    wire [REG_W-1:0] sum_register, product_register;
    wire [31:0]      sum_value, product_value;
    wire [31:0]      stored;                                        // cycle 3
    wire [4:0]       scale_flags;                                   // W
    dual_operands #(.CONFIG(CONFIG)) u_operands (.clk_i(clk_i),
        .sum_write_i(sum_write), .sum_register_i(sum_register), .sum_value_i(sum_value),
        .product_write_i(product_write), .product_register_i(product_register), .product_value_i(product_value),
        .issue_i(issue_i), .operands_o(operands_o), .stored_o(stored), .scale_flags_o(scale_flags));
    wire unused_issue = &{issue_minus_x, issue_minus_y, issue_twice, issue_half, issue_st_y,
                          issue_sum_x, issue_sum_y, issue_product_x, issue_product_y};

    // The store ------------------------------------------------------------------------------------------
    wire [31:0] word_w1;
    lane_store #(.CONFIG(CONFIG)) u_store (.clk_i(clk_i), .rst_i(rst_i), .record_i(issue_record),
        .st_i(issue_st), .lasts_i(1'b1), .register_i(issue_register),
        .row_i2_i(issue_st_row), .absent_i2_i({1'b0, issue_st_row} >= count_q), .asleep_i2_i(1'b0), .value_i3_i(stored),
        .load_i(retire_sum_loads || retire_product_loads), .row_w3_i(retire_load_row), .register_w3_i(retire_load_register), .word_o(word_w1),
        .host_i(access_valid), .host_write_i(write && access_space == HOST_OBJECT), .host_address_i(access_address),
        .host_word_i(data_i));

    // Results: written in W+1 ------------------------------------------------------------------------------
    reg              constant_q;                // the host's
    reg [BANK_W-1:0] constant_spot_q;           // in both banks
    reg [31:0]       other_q;                   // W: no result
    always @(posedge clk_i) begin
        constant_q      <= !rst_i && access_valid && access_write && access_space == HOST_CONSTANT;     // of all lanes
        constant_spot_q <= {{CONTEXT_W-1{1'b1}}, access_address[REGISTER_W-1:0]};
        other_q         <= loads_w1 ? word_w1 : data_i;
    end
    wire [31:0]      sum, product;
    wire [4:0]       sum_flags, product_flags, sum_raised, product_raised;
    wire [ROW_W-1:0] sum_row, product_row;                          // W+1
    assign {product_flags, product, sum_flags, sum} = result_i;
    wire sum_writes     = sum_there_w0 && (adds_w0 || sum_loads_w0);
    wire product_writes = product_there_w0 && product_valid_w0;
    delay #(.W(2*ROW_W), .N(TIMING_DUAL_END+1)) u_rows (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({retire_product_row, retire_sum_row}), .q_o({product_row, sum_row}));
    lane_result #(.CONFIG(CONFIG)) u_sum (.clk_i(clk_i), .rst_i(rst_i), .valid_i(sum_valid_w0),
        .absent_i(!sum_there_w0), .executed_i(1'b1), .writes_i(sum_writes), .raises_i(FLAGS != 0 && sum_there_w0 && adds_w0),
        .constant_i(constant_q), .register_i(constant_q ? {constant_spot_q, 1'b0} : sum_register_w0),
        .value_i(adds_w0 ? sum : other_q), .flags_i(sum_flags | scale_flags), .row_late_i(sum_row),
        .write_o(sum_write), .register_o(sum_register), .value_o(sum_value), .flags_o(sum_raised), .written_o(written_o[0 +: `WRITTEN_W]));
    lane_result #(.CONFIG(CONFIG)) u_product (.clk_i(clk_i), .rst_i(rst_i), .valid_i(product_valid_w0),
        .absent_i(!product_there_w0), .executed_i(1'b1), .writes_i(product_writes), .raises_i(FLAGS != 0 && product_writes && !product_loads_w0),
        .constant_i(constant_q), .register_i(constant_q ? {constant_spot_q, 1'b0} : product_register_w0),
        .value_i(product_loads_w0 || constant_q ? other_q : product), .flags_i(product_flags), .row_late_i(product_row),
        .write_o(product_write), .register_o(product_register), .value_o(product_value), .flags_o(product_raised),
        .written_o(written_o[`WRITTEN_W +: `WRITTEN_W]));

    // What the sequencer and the host hear -----------------------------------------------------------------
    lane_report #(.CONFIG(CONFIG)) u_report (.clk_i(clk_i), .rst_i(rst_i), .report_i(report_i),
        .count_i(count_q), .flags_i(sum_raised | product_raised), .asleep_i(1'b0),
        .valid_i(1'b0), .batch_i(1'b0), .context_i({CONTEXT_W{1'b0}}),
        .mine_i(mine), .space_i(access_space), .stored_i(word_w1), .status_i(32'd0), .report_o(report_o));
endmodule
`default_nettype wire
