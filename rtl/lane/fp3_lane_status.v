// SPDX-License-Identifier: Apache-2.0
// fp3_lane_status: of each object the step of its first failure, and its exceptions.
//
// Purpose   A word for each row: {step of the first NV or OF (27 bits), exceptions}. Each result of
//           the arithmetic adds its exceptions. Without STATUS there are no words, and status_o is
//           0.
//
// Latency   row_w3_i to status_o three cycles; the new word is written two cycles after flags_i.
// Hazard    One row does not come twice within 4 cycles.
//           The host accesses words when no instruction is in the lane (checked there).
//
//     cycle    W-3        W-2   W-1    W                               W+1       W+2
//              row_w3_i   read         status_o, raises_i, flags_i     written   there
`default_nettype none
module fp3_lane_status #(
    parameter STATUS = 1,
    parameter ROW_W  = 7               // bits of a row's number
) (
    input  wire             clk_i,
    input  wire             rst_i,
    input  wire [ROW_W-1:0] row_w3_i,
    // W
    input  wire             raises_i,       // flags_i are exceptions of the object ...
    input  wire [4:0]       flags_i,
    input  wire [26:0]      step_i,         // ... in this step
    output wire [31:0]      status_o,
    // The host
    input  wire             host_i,         // host_row_i is read
    input  wire             host_write_i,
    input  wire [ROW_W-1:0] host_row_i,
    input  wire [31:0]      host_word_i
);
    generate
        if (STATUS != 0) begin : g_status
            wire [ROW_W-1:0] row_w0;
            reg              write_q;                   // W+1
            reg  [ROW_W-1:0] row_q, address_q;          // W-2, W+1
            reg  [31:0]      word_q;
            wire             fails = status_o[31:5] == 27'd0 && (flags_i[4] || flags_i[2]);
            fp3_delay #(.W(ROW_W), .N(2)) u_row (.clk_i(clk_i), .rst_i(1'b0), .d_i(row_q), .q_o(row_w0));
            always @(posedge clk_i) begin
                row_q     <= host_i ? host_row_i : row_w3_i;
                write_q   <= !rst_i && (raises_i || host_write_i);
                address_q <= host_i ? host_row_i : row_w0;
                word_q    <= host_i ? host_word_i : {fails ? step_i : status_o[31:5], status_o[4:0] | flags_i};
            end
            fp3_ram_registered #(.ADDR_W(ROW_W)) u_status (.clk_i(clk_i), .write_i(write_q && !rst_i),
                .write_addr_i(address_q), .write_value_i(word_q),
                .read_i(1'b1), .read_addr_i(row_q), .read_value_o(status_o));
`ifdef FP3_CHECK
            reg [2:0]       raised_q;                   // the last three cycles
            reg [3*ROW_W-1:0] rows_q;
            integer         k;
            always @(posedge clk_i) begin
                {raised_q, rows_q} <= {raised_q[1:0], raises_i && !rst_i, rows_q[2*ROW_W-1:0], row_w0};
                for (k = 0; k < 3; k = k + 1)
                    if (!rst_i && raises_i && raised_q[k] && rows_q[ROW_W*k +: ROW_W] == row_w0) begin
                        $display("%m: row %0d comes again after %0d cycles", row_w0, k + 1); $stop;
                    end
            end
`endif
        end else begin : g_no_status
            assign status_o = 32'd0;
            wire unused = &{clk_i, rst_i, row_w3_i, raises_i, flags_i, step_i, host_i, host_write_i, host_row_i, host_word_i};
        end
    endgenerate
endmodule
`default_nettype wire
