// exponent_spec: fp3_fp_exponent.v, for every number: a power of two of an integral part, and the exponent of a number as a number.
`default_nettype none
module exponent_spec #(
    parameter CUT    = 0,
    parameter FINITE = 0,
    parameter LEMMAS = 1
) (
    input wire         clk_i,
    input wire         log_i,
    input wire [31:16] a_i
);
    wire [31:0] z;
    fp3_fp_exponent #(.CUT(CUT), .FINITE(FINITE)) u_exponent (.clk_i(clk_i), .log_i(log_i), .a_i(a_i), .z_o(z));
    reg [16:0] late_q, before_q;
    reg [1:0]  age_q = 2'd0;
    always @(posedge clk_i) begin
        {before_q, late_q} <= {late_q, log_i, a_i};
        if (age_q != 2'd2) age_q <= age_q + 1'b1;
    end
    wire         log;
    wire [31:16] a;
    assign {log, a} = CUT != 0 ? before_q : late_q;
    wire [7:0]   e     = a[30:23];
    localparam [30:0] MOST = FINITE != 0 ? 31'h7fffffff : 31'h7f800000;
    // exp2: the integral part is below 256, or out of range anyway
    wire [9:0]   n     = e < 8'd127 ? 10'd0 : e > 8'd134 ? 10'd1023 : {2'd0, 1'b1, a[22:16]} >> (8'd134 - e);
    wire [30:0]  power = a[31] ? (n <= 126 ? {8'd127 - n[7:0], 23'd0} : n <= 149 ? 31'd1 << (149 - n) : 31'd0)
                               : n <= 127 + (FINITE != 0) ? {8'd127 + n[7:0], 23'd0} : MOST;
    // logb: z is an integer with this magnitude
    wire [7:0]   m     = e < 8'd127 ? 8'd127 - e : e - 8'd127;
    wire [23:0]  sig   = {1'b1, z[22:0]};
    wire         top   = FINITE == 0 && e == 8'd255;
    always @* if (age_q == 2'd2 && !(FINITE == 0 && e == 8'd255 && a[22:16] != 0)) begin
        if (!log)           assert (z == {1'b0, power});
        else if (e == 8'd0) assert (z == {1'b1, MOST});
        else if (top)       assert (z == {1'b0, MOST});
        else if (m == 0)    assert (z == 0);
        else begin
            assert (z[31] == (e < 8'd127) && z[30:23] >= 8'd127 && z[30:23] <= 8'd134);
            assert ({16'd0, m} << (8'd150 - z[30:23]) == sig);
        end
    end
endmodule
`default_nettype wire
