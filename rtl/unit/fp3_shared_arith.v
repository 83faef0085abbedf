// SPDX-License-Identifier: Apache-2.0
// fp3_shared_arith: one adder and one multiplier for several schedulers.
//
// Purpose   The paper's Figure 3. In each cycle one scheduler may use the adder and one the
//           multiplier; a chained instruction uses both. All results have the same latency: each
//           operation is delayed by the latency of the unit that it skips.
//
//           add    z, y of one ─────── wait ──────┬► adder ───────► result
//           mul    x, y of one ─► multiplier ─────┘ chained
//                                      └──────────── wait ────────► result
//
// Latency   TIMING_SHARE + MUL_LATENCY + ADD_LATENCY from operands to results; new operands every
//           cycle.
// Hazard    adds_i and muls_i come in the cycle of the operands, with at most one scheduler in
//           each. twice and halve never come together.
`default_nettype none
`include "unit/socket.vh"
module fp3_shared_arith #(
`include "config/config.vh"
) (
    input  wire                              clk_i,
    // Both units: z +/- x * y; the adder alone: z +/- y; the multiplier alone: x * y
    input  wire [SCHEDULERS-1:0]             adds_i,
    input  wire [SCHEDULERS-1:0]             muls_i,
    input  wire [`FP3_OPERANDS_W*SCHEDULERS-1:0] operands_i,
    output wire [`FP3_RESULT_W*SCHEDULERS-1:0]   result_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"
    // The operands of the granted schedulers: all for the adder, x and y for the multiplier
    reg [`FP3_OPERANDS_W-1:0] add;
    reg [63:0]            mul;
    integer               k;
    always @* begin
        {add, mul} = {`FP3_OPERANDS_W+64{1'b0}};           // CHOICE_NONE is 0
        for (k = 0; k < SCHEDULERS; k = k + 1) begin
            add = add | (operands_i[`FP3_OPERANDS_W*k +: `FP3_OPERANDS_W] & {`FP3_OPERANDS_W{adds_i[k]}});
            mul = mul | (operands_i[`FP3_OPERANDS_W*k +: 64] & {64{muls_i[k]}});
        end
    end
    `FP3_OPERANDS_FIELDS
    assign `FP3_OPERANDS = add;
    reg [31:0]         mul_x_q, mul_y_q, y_q, z_q;
    reg                subtract_q, chain_q, twice_q, halve_q, true_q;
    reg [CHOICE_W-1:0] choice_q;
    always @(posedge clk_i) begin
        {mul_x_q, mul_y_q, y_q, z_q} <= {mul, operands_y, operands_z};
        {subtract_q, chain_q, twice_q, halve_q} <= {operands_subtract, |(adds_i & muls_i), operands_twice, operands_halve};
        {true_q, choice_q} <= {|operands_x[30:NONZERO_FROM], operands_choice};
    end

    // Beside the multiplier: y, twice or half of it, rounded as a product would be
    wire [31:0] scaled, y_late, z_late;
    wire [31:0] y_beside = choice_q != CHOICE_NONE ? BITS_MINUS_ZERO : scaled;
    wire        unused_no_product;
    wire [4:0]  scale_flags, scale_flags_late;
    wire        subtract_late, chain_late;
    generate
        if (SCALE != 0) begin : g_scale
            wire [31:BELOW] moved;
            assign scaled = {moved, {BELOW{1'b0}}};
            fp3_fp_scale #(.FRAC(FRACTION), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE)) u_scale (
                .clk_i(clk_i), .twice_i(twice_q), .halve_i(halve_q),
                .d_i(y_q[31:BELOW]), .z_o(moved), .flags_o(scale_flags));
        end else begin : g_no_scale
            wire unused_scale = twice_q | halve_q;
            assign {scaled, scale_flags} = {y_q, 5'd0};
        end
    endgenerate
    fp3_delay #(.W(34), .N(MUL_LATENCY)) u_beside (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({y_beside, subtract_q, chain_q}), .q_o({y_late, subtract_late, chain_late}));
    fp3_fp_value #(.CONFIG(CONFIG)) u_z (.clk_i(clk_i),
        .choice_i(choice_q), .a_i(z_q), .b_i(y_q), .true_i(true_q), .z_o(z_late), .no_product_o(unused_no_product));
    fp3_delay #(.W(5), .N(MUL_LATENCY + ADD_LATENCY)) u_scale_flags (.clk_i(clk_i), .rst_i(1'b0),
        .d_i(scale_flags), .q_o(scale_flags_late));

    wire [31:0] product, sum, product_late;
    wire [4:0]  product_flags, sum_flags, product_flags_late;
    fp3_multiplier #(.CONFIG(CONFIG)) u_mul (.clk_i(clk_i), .no_product_i(1'b0), .instead_i(37'd0),
        .a_i(mul_x_q), .b_i(mul_y_q), .value_o(product), .flags_o(product_flags));
    fp3_adder #(.CONFIG(CONFIG)) u_add (.clk_i(clk_i), .subtract_i(subtract_late),
        .a_i(z_late), .b_i(chain_late ? product : y_late), .value_o(sum), .flags_o(sum_flags));
    fp3_delay #(.W(37), .N(ADD_LATENCY)) u_late (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({product_flags, product}), .q_o({product_flags_late, product_late}));

    // Results go to all schedulers
    genvar n;
    generate
        for (n = 0; n < SCHEDULERS; n = n + 1) begin : g_result
            `FP3_RESULT_FIELDS
            wire adds, muls;
            fp3_delay #(.W(2), .N(UNIT_LATENCY)) u_uses (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({adds_i[n], muls_i[n]}), .q_o({adds, muls}));
            assign result_value = adds ? sum : product_late;
            assign result_flags = (adds ? sum_flags : 5'd0) | (muls ? product_flags_late : 5'd0)
                                | (adds && !muls ? scale_flags_late : 5'd0);
            assign result_o[`FP3_RESULT_W*n +: `FP3_RESULT_W] = `FP3_RESULT;
        end
    endgenerate

`ifdef FP3_CHECK
    reg [15:0] clean_q;                                   // what the delays had at power-up has left
    initial    clean_q = 16'd0;
    always @(posedge clk_i) begin
        clean_q <= {clean_q[14:0], 1'b1};
        if (clean_q[15] && (|(adds_i & (adds_i - 1'b1)) || |(muls_i & (muls_i - 1'b1)))) begin
            $display("%m: adders %b and multipliers %b for one of each", adds_i, muls_i);
            $stop;
        end
        if (clean_q[15] && twice_q && halve_q) begin
            $display("%m: twice and halve at once");
            $stop;
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
