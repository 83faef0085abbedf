// value.vh: what fp_value does. decode says it, the arithmetic does it. Included inside a module.
// verilator lint_off UNUSEDPARAM
localparam [3:0] VALUE_PLAIN = 4'd0;   // nothing: the operand itself
localparam [3:0] VALUE_MIN   = 4'd1;
localparam [3:0] VALUE_MAX   = 4'd2;
localparam [3:0] VALUE_ABS   = 4'd3;
localparam [3:0] VALUE_LT    = 4'd4;
localparam [3:0] VALUE_LE    = 4'd5;
localparam [3:0] VALUE_SEL   = 4'd6;
localparam [3:0] VALUE_RCP   = 4'd7;
localparam [3:0] VALUE_RSQRT = 4'd8;
// verilator lint_on UNUSEDPARAM
