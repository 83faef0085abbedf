// SPDX-License-Identifier: Apache-2.0
// fp3_solo_arith: the pipelined adder and multiplier, and the chain from one to the other.
//
// Purpose   Operands are sampled every cycle; idle cycles carry garbage. A result appears a fixed
//           number of cycles later in the unit's result register. The scheduler knows when, so no
//           valid bit and no tag travel with operands.
//
//               x, y ──► multiplier ──► product_o
//                              │ chained
//               a, b ──────────┴► adder ──► sum_o
//
// Latency   ADD_LATENCY, MUL_LATENCY; chained: their sum. New operands every cycle.
// Hazard    chain_soon_o announces that a chained product takes the adder in the next cycle:
//           no addition may issue then (solo checks it), and the adder's operands are to
//           be chain_z_o and the product.
`default_nettype none
`include "unit/socket.vh"
module fp3_solo_arith #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire                   rst_i,
    input  wire                   chain_i,        // the product goes on to the adder: z +/- x * y
    input  wire [`FP3_OPERANDS_W-1:0] operands_i,     // with a choice chain_i is 1
    input  wire [31:0]            add_a_i,        // the adder's, of a chain, too
    input  wire [31:0]            add_b_i,
    output wire                   chain_soon_o,
    output wire [31:0]            chain_z_o,      // the addend of the product that takes the adder in this cycle
    output wire [`FP3_RESULT_W-1:0]   sum_o,
    output wire [`FP3_RESULT_W-1:0]   product_o
);
`include "gen/isa.vh"
    `FP3_OPERANDS_FIELDS
    assign `FP3_OPERANDS = operands_i;

    wire [31:0] sum, product;
    wire [4:0]  sum_flags, product_flags;

    // The chain's other operand waits for the product.
    wire        chained;               // a product reaches the adder in this cycle
    wire        chain_subtract;
    wire [4:0]  chain_flags;
    wire        no_product;            // in the next cycle
    generate
        if (CHAIN != 0 || VALUES != 0) begin : g_chain
            wire soon;
            fp3_delay #(.W(1), .N(MUL_LATENCY-1)) u_soon (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(chain_i), .q_o(soon));
            fp3_delay #(.W(1), .N(1)) u_chained (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(soon), .q_o(chained));
            fp3_delay #(.W(1), .N(MUL_LATENCY)) u_subtract (.clk_i(clk_i), .rst_i(1'b0),
                .d_i(operands_subtract), .q_o(chain_subtract));
            fp3_fp_value #(.CONFIG(CONFIG)) u_c (.clk_i(clk_i),
                .choice_i(operands_choice), .a_i(operands_z), .b_i(operands_y), .true_i(|operands_x[30:NONZERO_FROM]),
                .z_o(chain_z_o), .no_product_o(no_product));
            fp3_delay #(.W(5), .N(ADD_LATENCY)) u_flags (.clk_i(clk_i), .rst_i(1'b0),
                .d_i(chained ? product_flags : 5'd0), .q_o(chain_flags));
            assign chain_soon_o = soon;
        end else begin : g_no_chain
            wire unused_chain = |{chain_i, rst_i};
            assign {chain_soon_o, chained, chain_subtract, chain_z_o, chain_flags, no_product} = 41'd0;
        end
    endgenerate

    fp3_adder #(.CONFIG(CONFIG)) u_add (.clk_i(clk_i), .subtract_i(chained ? chain_subtract : operands_subtract),
        .a_i(add_a_i), .b_i(add_b_i), .value_o(sum), .flags_o(sum_flags));
    fp3_multiplier #(.CONFIG(CONFIG)) u_mul (.clk_i(clk_i), .no_product_i(no_product),
        .instead_i({5'd0, BITS_MINUS_ZERO}),
        .a_i(operands_x), .b_i(operands_y), .value_o(product), .flags_o(product_flags));
    assign sum_o     = {sum_flags | chain_flags, sum};
    assign product_o = {product_flags, product};
endmodule
`default_nettype wire
`include "config/undefine.vh"
