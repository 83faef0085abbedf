// fetch: instruction memory, program counter and the step loop.
//
// Purpose   Delivers a run's instructions in order: the first part once, the step part
//           `steps` times, the last part once. The loop costs no instruction and no cycle.
//
//           0 ........ step ........ last ........ size
//           first part |  step part  |  last part  |
//
// Latency   3: the first word is on word_o three cycles after start_i, then one per cycle
//           in which advance_i is high.
// Hazard    advance_i low holds everything but start and stop. stop_i drops what was fetched and not taken.
`default_nettype none
module fetch #(
    parameter ADDR_W = 9               // 2^ADDR_W instruction words
) (
    input  wire              clk_i,
    input  wire              rst_i,
    // Program memory
    input  wire              write_i,
    input  wire [ADDR_W-1:0] write_addr_i,
    input  wire [31:0]       write_word_i,
    // A run; what describes it is stable from start_i to its end
    input  wire              start_i,
    input  wire              stop_i,
    input  wire [31:0]       steps_i,   // >= 1
    input  wire [ADDR_W-1:0] step_i,    // first word of the step part
    input  wire [ADDR_W-1:0] step_end_i,// its last word
    input  wire [ADDR_W-1:0] end_i,     // the program's last word
    // To decode
    input  wire              advance_i,
    output wire              valid_o,
    output wire [ADDR_W-1:0] pc_o,
    output wire [31:0]       word_o,
    output wire              empty_o    // nothing left to deliver
);
    reg [ADDR_W-1:0] pc_q;
    reg [31:0]       steps_q;           // step parts left to begin, after this one
    reg              active_q;          // pc_q points to a word to be fetched

    wire again = pc_q == step_end_i && steps_q != 0;

    always @(posedge clk_i)
        if (start_i) begin
            pc_q    <= {ADDR_W{1'b0}};
            steps_q <= steps_i - 1'b1;
        end else if (advance_i && active_q) begin
            pc_q    <= again ? step_i : pc_q + 1'b1;
            steps_q <= steps_q - {31'b0, again};
        end

    // The word is registered behind the memory, whose own output is late in its cycle.
    wire [31:0]      word;
    reg [ADDR_W-1:0] pc_1q, pc_2q;
    reg              valid_1q, valid_2q;
    reg [31:0]       word_q;

    ram_1r1w #(.ADDR_W(ADDR_W)) u_program (
        .clk_i(clk_i), .write_i(write_i), .write_addr_i(write_addr_i), .write_value_i(write_word_i),
        .read_i(advance_i && active_q), .read_addr_i(pc_q), .read_value_o(word));

    always @(posedge clk_i)
        if (rst_i || stop_i) begin
            active_q <= 1'b0;
            valid_1q <= 1'b0;
            valid_2q <= 1'b0;
        end else if (start_i) begin
            active_q <= 1'b1;
        end else if (advance_i) begin
            active_q <= active_q && (again || pc_q != end_i);
            valid_1q <= active_q;
            valid_2q <= valid_1q;
        end

    always @(posedge clk_i)
        if (advance_i) begin
            pc_1q  <= pc_q;
            pc_2q  <= pc_1q;
            word_q <= word;
        end

    assign valid_o = valid_2q;
    assign pc_o    = pc_2q;
    assign word_o  = word_q;
    assign empty_o = !active_q && !valid_1q && !valid_2q;
endmodule
`default_nettype wire
