// mul_facts: the significands of two factors, and what is true of their product.
`default_nettype none
module mul_facts #(
    parameter EXP = 8, FRAC = 23
) (
    input  wire [EXP+FRAC-1:0] a_i, b_i,       // without their signs
    input  wire [2*FRAC+1:0]   product_i,      // meant to be sig_a_o * sig_b_o
    output wire [FRAC:0]       sig_a_o, sig_b_o,
    output wire [FRAC:0]       normal_a_o, normal_b_o,   // shifted until the top bit is 1
    output wire [2*FRAC+1:0]   normal_product_o,         // normal_a_o * normal_b_o, if product_i is right
    output wire                finite_o,       // both operands are finite and not zero
    output wire                possible_o      // product_i is one that two such significands can have
);
    wire [EXP-1:0] field_a = a_i[FRAC +: EXP], field_b = b_i[FRAC +: EXP];

    assign sig_a_o  = {field_a != 0, a_i[FRAC-1:0]};
    assign sig_b_o  = {field_b != 0, b_i[FRAC-1:0]};
    assign finite_o = ~&field_a & ~&field_b & |sig_a_o & |sig_b_o;

    reg [FRAC:0]     normal_a, normal_b;
    reg [2*FRAC+1:0] product;
    reg              lost;
    integer i;
    always @* begin
        normal_a = sig_a_o;
        normal_b = sig_b_o;
        product  = product_i;
        lost     = 1'b0;
        for (i = 0; i < FRAC; i = i + 1) begin
            if (!normal_a[FRAC]) begin
                normal_a = normal_a << 1;
                {lost, product} = {lost | product[2*FRAC+1], product << 1};
            end
            if (!normal_b[FRAC]) begin
                normal_b = normal_b << 1;
                {lost, product} = {lost | product[2*FRAC+1], product << 1};
            end
        end
    end
    assign normal_a_o       = normal_a;
    assign normal_b_o       = normal_b;
    assign normal_product_o = product;

    // Zero exactly if a significand is; else the normal product lies in [2^(2 FRAC), 2^(2 FRAC+2)).
    assign possible_o = |sig_a_o & |sig_b_o ? !lost & |product[2*FRAC+1:2*FRAC] : product_i == 0;
endmodule
`default_nettype wire
