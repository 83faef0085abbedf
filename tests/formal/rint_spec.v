// rint_spec: fp3_fp_rint.v against IEEE 754's roundToIntegral, for every number, as integers.
`default_nettype none
module rint_spec #(
    parameter CUT     = 0,
    parameter NEAREST = 1,
    parameter LEMMAS  = 1
) (
    input wire        clk_i,
    input wire [31:0] a_i
);
    wire [31:0] z;
    fp3_fp_rint #(.CUT(CUT), .NEAREST(NEAREST)) u_rint (.clk_i(clk_i), .a_i(a_i), .z_o(z));
    reg [31:0] late_q, before_q;
    reg [1:0]  age_q = 2'd0;
    always @(posedge clk_i) begin
        {before_q, late_q} <= {late_q, a_i};
        if (age_q != 2'd2) age_q <= age_q + 1'b1;
    end
    wire [31:0] a     = CUT != 0 ? before_q : late_q;
    // |a| in units of 2^-24, below 2^23; less than one of them is sticky
    wire [7:0]  e     = a[30:23];
    wire [23:0] sig   = {e != 8'd0, a[22:0]};
    wire [47:0] x     = e < 8'd103 ? {47'd0, a[30:0] != 0} : e < 8'd126 ? ({24'd0, sig} >> (8'd126 - e)) | |(sig & ((24'd1 << (8'd126 - e)) - 1'b1))
                                                                        : {24'd0, sig} << (e - 8'd126);
    wire [23:0] whole = x[47:24];
    wire        up    = NEAREST != 0 && (x[23:0] > 24'h800000 || (x[23:0] == 24'h800000 && whole[0]));
    wire [23:0] r     = whole + up;
    wire [23:0] sig_z = {1'b1, z[22:0]};
    always @* if (age_q == 2'd2) begin
        assert (z[31] == a[31]);
        if (e >= 8'd150)  assert (z == a);
        else if (r == 0)  assert (z[30:0] == 0);
        else begin
            assert (z[30:23] >= 8'd127 && z[30:23] <= 8'd150);
            assert ({24'd0, r} << (8'd150 - z[30:23]) == {24'd0, sig_z});
        end
    end
endmodule
`default_nettype wire
