// SPDX-License-Identifier: Apache-2.0
// fp3_lane_operands: a lane's registers, and the operands x, y and z that an instruction takes from
// them.
//
// Purpose   Three copies of the registers, for three reads in a cycle. A sum is z +/- 1 * y (or 2,
//           1/2), a product -0 + x * y: the same bits and flags as the plain operation. The 1 and
//           the -0 come from the set and reset inputs of the operands' registers. y may be a word
//           of a neighbour. For z - y, z is used as it is; for y - z, z is negated: -z + 1 * y.
// Latency   Three cycles from the registers' numbers to the operands. z is named, and comes, Z_LATE
//           cycles after x and y. less_o comes with the result.
// Hazard    There are no interlocks: registers are named in time (lane, which checks it).
//
//     cycle        0              1, 2         3                         3 + UNIT_LATENCY
//                  issue_y        memories     operands_y = 40000000     less_o: |x| < y
//                  issue_one                   operands_x = 3f800000
`default_nettype none
`include "lane/bundles.vh"
module fp3_lane_operands #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire                   write_i,
    input  wire [REG_W-1:0]       write_register_i,
    input  wire [31:0]            write_value_i,
    input  wire [`FP3_ISSUE_W-1:0]    issue_i,        // cycle 0
    input  wire [31:0]            word_i2_i,      // cycle 2: what a neighbour gives
    output wire [`FP3_OPERANDS_W-1:0] operands_o,     // cycle 3
    output wire [31:0]            stored_o,       // likewise: of a store, or of `each`
    output wire                   less_o          // with the result: |x| < y
);
`include "gen/isa.vh"
    `FP3_ISSUE_FIELDS
    `FP3_OPERANDS_FIELDS
    assign `FP3_ISSUE     = issue_i;
    assign operands_o = `FP3_OPERANDS;

    wire [31:0] x_i2, y_i2, z_i2;
    fp3_ram_registered #(.ADDR_W(REG_W)) u_x (.clk_i(clk_i), .write_i(write_i),
        .write_addr_i(write_register_i), .write_value_i(write_value_i),
        .read_i(1'b1), .read_addr_i(issue_x), .read_value_o(x_i2));
    fp3_ram_registered #(.ADDR_W(REG_W)) u_y (.clk_i(clk_i), .write_i(write_i),
        .write_addr_i(write_register_i), .write_value_i(write_value_i),
        .read_i(1'b1), .read_addr_i(issue_y), .read_value_o(y_i2));
    generate
        if (CHAIN != 0 || FUSED != 0) begin : g_z
            fp3_ram_registered #(.ADDR_W(REG_W)) u_z (.clk_i(clk_i), .write_i(write_i),
                .write_addr_i(write_register_i), .write_value_i(write_value_i),
                .read_i(1'b1), .read_addr_i(issue_z), .read_value_o(z_i2));
        end else begin : g_no_z
            // No instruction has both: z is where x is.
            assign z_i2 = x_i2;
        end
    endgenerate

    // A neighbour's word instead of a register, and z negated for y - z.
    wire [31:0] y_or_word_i2, signed_z_i2;
    generate
        if (NEIGHBOURS != 0) begin : g_given
            wire given_i2, minus_i2;
            fp3_delay #(.W(2), .N(2)) u_given (.clk_i(clk_i), .rst_i(1'b0), .d_i({issue_given, issue_minus}),
                .q_o({given_i2, minus_i2}));
            assign y_or_word_i2 = given_i2 ? word_i2_i : y_i2;
            assign signed_z_i2  = {z_i2[31] ^ minus_i2, z_i2[30:0]};
        end else begin : g_not_given
            wire unused_given = &word_i2_i;
            assign {y_or_word_i2, signed_z_i2} = {y_i2, z_i2};
        end
    endgenerate

    wire       twice_i2, halve_i2, one_i2, zero_i2;
    reg [31:0] x_q, y_q, z_q;           // cycle 3
    fp3_delay #(.W(4), .N(2)) u_force (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({issue_twice, issue_halve, issue_one, issue_zero}), .q_o({twice_i2, halve_i2, one_i2, zero_i2}));
    fp3_delay #(.W(2), .N(1)) u_scale (.clk_i(clk_i), .rst_i(1'b0), .d_i({twice_i2, halve_i2}),
        .q_o({operands_twice, operands_halve}));
    fp3_delay #(.W(CHOICE_W+1), .N(TIMING_OPERANDS)) u_choice (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({issue_choice, issue_subtract}), .q_o({operands_choice, operands_subtract}));
    always @(posedge clk_i) begin
        y_q <= y_or_word_i2;
        // 1 with its exponent as it is, one more or one less
        if (one_i2)  x_q <= {BITS_ONE[31], twice_i2, BITS_ONE[29:24] & {6{!twice_i2}},
                             BITS_ONE[23] && !twice_i2 && !halve_i2, BITS_ONE[22:0]};
        else         x_q <= x_i2;
        if (zero_i2) z_q <= BITS_MINUS_ZERO;
        else         z_q <= signed_z_i2;
    end
    assign {operands_x, operands_y, operands_z} = {x_q, y_q, z_q};
    assign stored_o = x_q;

    // sleep compares magnitudes as integers. A NaN is not less than a number; no number is less
    // than a zero or a number read as zero.
    generate
        if (SLEEP != 0) begin : g_less
            reg less_q;
            always @(posedge clk_i)
                less_q <= (x_q[30:0] & KEPT[30:0]) < (y_q[30:0] & KEPT[30:0]) && !y_q[31] && (FINITE == 0 ? (y_q[30:0] & KEPT[30:0]) <= 31'h7f800000 : |y_q[30:23]);
            fp3_delay #(.W(1), .N(UNIT_LATENCY-1)) u_less (.clk_i(clk_i), .rst_i(1'b0), .d_i(less_q), .q_o(less_o));
        end else begin : g_no_less
            assign less_o = 1'b0;
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
