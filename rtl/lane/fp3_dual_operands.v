// SPDX-License-Identifier: Apache-2.0
// fp3_dual_operands: a lane's registers in two banks, and the operands that a sum and a product
// take from them at once.
//
// Purpose   Sums are written to one bank, products to the other; every operation reads at most one
//           register of each bank, so four memories with one read and one write port are enough,
//           and no operand needs a multiplexer. A store is a sum with one operand left out: the
//           other operand is stored unchanged.
// Latency   Three cycles from the register numbers to the operands. The register of a sum's y is
//           named TIMING_EARLY cycles before the others: its word waits a cycle, and is scaled in
//           two. scale_flags_o comes with the result.
// Hazard    There are no interlocks: the sequencer names registers in time, and checks this.
//
//     cycle      -2             0                  1        2                    3
//                issue_sum_y    issue_sum_x ..     waits    read, y is scaled    operands_o, stored_o
`default_nettype none
`include "lane/bundles.vh"
module fp3_dual_operands #(
`include "config/config.vh"
) (
    input  wire                     clk_i,
    // Of the product, of the sum
    input  wire [1:0]               write_i,
    input  wire [2*REG_W-1:0]       write_register_i,
    input  wire [63:0]              write_value_i,
    input  wire [`FP3_DUAL_ISSUE_W-1:0] issue_i,           // cycle 0
    output wire [2*`FP3_OPERANDS_W-1:0] operands_o,        // cycle 3: of the product, of the sum
    output wire [31:0]              stored_o,          // likewise
    output wire [4:0]               scale_flags_o      // with the result: overflow or underflow, each of them inexact
);
`include "gen/choices.vh"
    `FP3_DUAL_ISSUE_FIELDS
    assign `FP3_DUAL_ISSUE = issue_i;
    wire unused = &{write_register_i[0], write_register_i[REG_W]};

    wire [BANK_W-1:0] sum_spot     = write_register_i[REG_W-1:1];
    wire [BANK_W-1:0] product_spot = write_register_i[2*REG_W-1:REG_W+1];
    wire [31:0] sum_x, product_x, product_y;           // cycle 2
    wire [31:0] sum_y_read;                            // cycle 0
    reg  [31:0] sum_y_q;
    always @(posedge clk_i) sum_y_q <= sum_y_read;
    fp3_ram_registered #(.ADDR_W(BANK_W)) u_sum_x (.clk_i(clk_i), .write_i(write_i[0]),
        .write_addr_i(sum_spot), .write_value_i(write_value_i[31:0]),
        .read_i(1'b1), .read_addr_i(issue_sum_x), .read_value_o(sum_x));
    fp3_ram_registered #(.ADDR_W(BANK_W)) u_sum_y (.clk_i(clk_i), .write_i(write_i[1]),
        .write_addr_i(product_spot), .write_value_i(write_value_i[63:32]),
        .read_i(1'b1), .read_addr_i(issue_sum_y), .read_value_o(sum_y_read));
    fp3_ram_registered #(.ADDR_W(BANK_W)) u_product_x (.clk_i(clk_i), .write_i(write_i[0]),
        .write_addr_i(sum_spot), .write_value_i(write_value_i[31:0]),
        .read_i(1'b1), .read_addr_i(issue_product_x), .read_value_o(product_x));
    fp3_ram_registered #(.ADDR_W(BANK_W)) u_product_y (.clk_i(clk_i), .write_i(write_i[1]),
        .write_addr_i(product_spot), .write_value_i(write_value_i[63:32]),
        .read_i(1'b1), .read_addr_i(issue_product_y), .read_value_o(product_y));

    wire [CHOICE_W-1:0] choice_i3;
    fp3_delay #(.W(CHOICE_W), .N(3)) u_choice (.clk_i(clk_i), .rst_i(1'b0), .d_i(issue_choice), .q_o(choice_i3));
    wire        twice_i1, halve_i1, minus_x_i2, minus_y_i2, st_x_i2, st_y_i2;
    wire [31:0] scaled;                                // cycle 2
    fp3_delay #(.W(2), .N(1)) u_scale_by (.clk_i(clk_i), .rst_i(1'b0), .d_i({issue_twice, issue_halve}),
        .q_o({twice_i1, halve_i1}));
    fp3_delay #(.W(4), .N(2)) u_force (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({issue_minus_x, issue_minus_y, issue_st && !issue_st_y, issue_st && issue_st_y}),
        .q_o({minus_x_i2, minus_y_i2, st_x_i2, st_y_i2}));
    generate
        if (SCALE != 0) begin : g_scale
            wire [4:0] flags;
            wire       of, uf;
            fp3_fp_scale #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE), .SUM_LAST(1),
                .CUTS(1'b1)) u_scale (.clk_i(clk_i),
                .twice_i(twice_i1), .halve_i(halve_i1), .d_i(sum_y_q), .z_o(scaled), .flags_o(flags));
            fp3_delay #(.W(2), .N(UNIT_LATENCY+1)) u_flags (.clk_i(clk_i), .rst_i(1'b0), .d_i(flags[2:1]),
                .q_o({of, uf}));
            assign scale_flags_o = {2'b00, of, uf, of || uf};
            wire unused_flags = &flags;
        end else begin : g_no_scale
            assign scale_flags_o = 5'd0;
            wire unused_scale = twice_i1 | halve_i1;
            fp3_delay #(.W(32), .N(1)) u_plain (.clk_i(clk_i), .rst_i(1'b0), .d_i(sum_y_q), .q_o(scaled));
        end
    endgenerate

    reg        minus_q;
    reg [31:0] sum_x_q, sum_y_scaled_q, product_x_q, product_y_q;       // cycle 3
    always @(posedge clk_i) begin
        minus_q        <= minus_y_i2;
        sum_x_q        <= st_y_i2 ? 32'd0 : {sum_x[31] ^ minus_x_i2, sum_x[30:0]};
        sum_y_scaled_q <= st_x_i2 ? 32'd0 : scaled;
        {product_x_q, product_y_q} <= {product_x, product_y};
    end
    assign stored_o = sum_x_q | sum_y_scaled_q;

    // A sum is z +/- y, a product x * y; in its place, what fp_value makes of z is made of x.
    genvar p;
    generate
        for (p = 0; p < 2; p = p + 1) begin : g_stream
            `FP3_OPERANDS_FIELDS
            assign operands_choice   = p == 0 ? CHOICE_NONE : choice_i3;
            assign {operands_twice, operands_halve} = 2'b00;
            assign operands_subtract = p == 0 && minus_q;
            assign operands_z        = p == 0 ? sum_x_q : product_x_q;
            assign operands_x        = p == 0 ? 32'd0 : product_x_q;
            assign operands_y        = p == 0 ? sum_y_scaled_q : product_y_q;
            assign operands_o[`FP3_OPERANDS_W*p +: `FP3_OPERANDS_W] = `FP3_OPERANDS;
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
