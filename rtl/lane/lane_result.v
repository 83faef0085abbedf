// lane_result: the end of an instruction of one stream: what is written to the registers, and the trace of it.
//
// Purpose   The register between a result and the registers' write port, and what the host and the trace hear of it.
// Latency   One cycle.
// Hazard    The row comes a cycle later than the rest: it waits for nothing else.
//
//     cycle    W                              W+1
//              valid_i, writes_i, value_i     write_o, value_o; written_o; row_late_i
`default_nettype none
`include "lane/written.vh"
module lane_result #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire                   rst_i,
    // W: an instruction ends ...
    input  wire                   valid_i,
    input  wire                   absent_i,       // ... of which there is no object
    input  wire                   executed_i,
    input  wire                   writes_i,       // ... and writes a register
    input  wire                   raises_i,       // ... and flags_i are its exceptions
    input  wire                   constant_i,     // the host writes a register
    input  wire [REG_W-1:0]       register_i,     // {context, register}
    input  wire [31:0]            value_i,
    input  wire [4:0]             flags_i,
    input  wire [ROW_W-1:0]       row_late_i,     // W+1
    // W+1
    output wire                   write_o,
    output wire [REG_W-1:0]       register_o,
    output wire [31:0]            value_o,
    output wire [4:0]             flags_o,        // raised
    output wire [`WRITTEN_W-1:0]  written_o
);
    reg             write_q, retired_q, raises_q;
    reg [1:0]       end_q;
    reg [REG_W-1:0] register_q;
    reg [31:0]      value_q;
    reg [4:0]       flags_q;
    always @(posedge clk_i) begin
        end_q      <= rst_i || !valid_i ? 2'd0 : absent_i ? 2'd1 : executed_i ? 2'd3 : 2'd2;
        retired_q  <= !rst_i && writes_i;
        write_q    <= !rst_i && (writes_i || constant_i);
        raises_q   <= !rst_i && raises_i;
        {register_q, value_q, flags_q} <= {register_i, value_i, flags_i};
    end
    assign write_o    = write_q && !rst_i;
    assign register_o = register_q;
    assign value_o    = value_q;
    assign flags_o    = flags_q & {5{raises_q}};

    `WRITTEN_FIELDS
    assign written_end      = end_q;
    assign written_valid    = retired_q;
    assign written_context  = {{16-CONTEXT_W{1'b0}}, register_q[REG_W-1:REGISTER_W]};
    assign written_object   = {{32-ROW_W{1'b0}}, row_late_i};
    assign written_register = {{6-REGISTER_W{1'b0}}, register_q[REGISTER_W-1:0]};
    assign written_value    = value_q;
    assign written_flags    = flags_o;
    assign written_o        = `WRITTEN;
endmodule
`default_nettype wire
