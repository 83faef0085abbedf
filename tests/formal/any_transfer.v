// any_transfer: stands for fp3_transfer.v in the proof of fp3_master.v. It answers the host in the next cycle, and what it asks of the
// processor are reads or writes while any of them is under way, as transfer_spec.v shows. Whatever else it gives is anything.
`default_nettype none
module fp3_transfer #(
    parameter WORDS_W = 24,
    parameter READS_W = 4,
    parameter OPEN_W  = 6
) (
    input  wire              clk_i,
    input  wire              rst_i,
    input  wire              ask_i,
    input  wire              ask_write_i,
    input  wire [2:0]        ask_register_i,
    input  wire [31:0]       ask_wdata_i,
    output wire              told_o,
    output wire              told_write_o,
    output wire              told_error_o,
    output wire [31:0]       told_rdata_o,
    output wire              req_valid_o,
    input  wire              req_ready_i,
    output wire              req_write_o,
    output wire [31:2]       req_place_o,
    output wire [31:0]       req_wdata_o,
    input  wire              answered_i,
    input  wire              answer_error_i,
    input  wire [31:0]       answer_rdata_i,
    input  wire [OPEN_W-1:0] open_i,
    output wire              awvalid_o,
    input  wire              awready_i,
    output wire              arvalid_o,
    input  wire              arready_i,
    output wire [31:2]       address_o,
    output wire [7:0]        length_o,
    output wire              wvalid_o,
    input  wire              wready_i,
    output wire [31:0]       wdata_o,
    output wire              wstrobe_o,
    output wire              wlast_o,
    input  wire              bvalid_i,
    output wire              bready_o,
    input  wire              berror_i,
    input  wire              rvalid_i,
    output wire              rready_o,
    input  wire [31:0]       rdata_i,
    input  wire              rerror_i
);
    (* anyseq *) wire        error, valid, write, aw, ar, w, strobe, last, b, r;
    (* anyseq *) wire [31:0] rdata, wdata, data;
    (* anyseq *) wire [31:2] place, address;
    (* anyseq *) wire [7:0]  length;
    reg told_q, write_q, asked_q;
    always @(posedge clk_i) begin
        told_q  <= ask_i && !rst_i;
        write_q <= ask_write_i;
        if (req_valid_o && req_ready_i) asked_q <= req_write_o;
    end
    assign {told_o, told_write_o, told_error_o, told_rdata_o} = {told_q, write_q, error, rdata};
    assign req_valid_o = valid && (open_i == {OPEN_W{1'b0}} || write == asked_q);
    assign {req_write_o, req_place_o, req_wdata_o} = {write, place, wdata};
    assign {awvalid_o, arvalid_o, address_o, length_o, wvalid_o, wdata_o, wstrobe_o, wlast_o, bready_o, rready_o}
         = {aw, ar, address, length, w, data, strobe, last, b, r};
endmodule
`default_nettype wire
