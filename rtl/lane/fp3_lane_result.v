// SPDX-License-Identifier: Apache-2.0
// fp3_lane_result: the end of an instruction of one stream: the write to the registers, and its
// trace.
//
// Purpose   The register between a result and the registers' write port; reports the write to the
//           host and the trace.
// Latency   One cycle.
//
//     cycle    W                  W+1
//              end_i, value_i     write_o, value_o, written_o
`default_nettype none
`include "lane/bundles.vh"
module fp3_lane_result #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire                   rst_i,
    // W
    input  wire [`FP3_END_W-1:0]      end_i,
    input  wire                   raises_i,       // flags_i are its exceptions
    input  wire [4:0]             flags_i,
    input  wire [31:0]            value_i,
    input  wire                   constant_i,     // the host writes a register: no instruction ends
    input  wire [REG_W-1:0]       constant_register_i,
    // W+1
    output wire                   write_o,
    output wire [REG_W-1:0]       register_o,
    output wire [31:0]            value_o,
    output wire [4:0]             flags_o,        // raised
    output wire [`FP3_WRITTEN_W-1:0]  written_o
);
    `FP3_END_FIELDS
    assign `FP3_END = end_i;

    reg             write_q, retired_q, raises_q;
    reg [1:0]       end_q;
    reg [REG_W-1:0] register_q;
    reg [31:0]      value_q;
    reg [4:0]       flags_q;
    always @(posedge clk_i) begin
        end_q      <= rst_i || !end_valid ? 2'd0 : end_absent ? 2'd1 : end_executed ? 2'd3 : 2'd2;
        retired_q  <= !rst_i && end_writes;
        write_q    <= !rst_i && (end_writes || constant_i);
        raises_q   <= !rst_i && raises_i;
        register_q <= constant_i ? constant_register_i : end_register;
        {value_q, flags_q} <= {value_i, flags_i};
    end
    assign write_o    = write_q && !rst_i;
    assign register_o = register_q;
    assign value_o    = value_q;
    assign flags_o    = flags_q & {5{raises_q}};

    `FP3_WRITTEN_FIELDS
    assign written_end      = end_q;
    assign written_valid    = retired_q;
    assign written_context  = {{16-CONTEXT_W{1'b0}}, register_q[REG_W-1:REGISTER_W]};
    assign written_object   = {{32-ROW_W{1'b0}}, end_row};
    assign written_register = {{6-REGISTER_W{1'b0}}, register_q[REGISTER_W-1:0]};
    assign written_value    = value_q;
    assign written_flags    = flags_o;
    assign written_o        = `FP3_WRITTEN;
endmodule
`default_nettype wire
`include "config/undefine.vh"
