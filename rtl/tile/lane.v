// lane: the registers of some objects, the store behind them, and what becomes of each result.
//
// Purpose   Does what its sequencer says, one instruction in each cycle, for as many objects as
//           there are contexts, and says it to the next lane a cycle later. Whatever depends on an
//           object's data is decided here and nowhere else.
//
//           cycle     0        1, 2       3         .. LATENCY+3 = V           V+1
//           issue_i   named    registers  operands  arithmetic   result        written, retired
//           retire_i           named V-6, row V-3, store named V-2, its word   V
//
// Latency   A register that is named LATENCY + 5 cycles after the issue of the instruction that
//           writes it, or later, has the new value. All results are equally late, so everything
//           happens in the order of issue.
// Hazard    Nothing is interlocked here: the same context must not come twice within these cycles.
//           The host's accesses are for an idle sequencer. retire_i and data_i come so many cycles
//           after issue_i that they are there in V-6 and V.
`default_nettype none
module lane #(
    parameter REGISTER_W = 5,          // 2^REGISTER_W registers per context, as many constants
    parameter CONTEXTS   = 24,         // the constants are one context more
    parameter CONTEXT_W  = 5,
    parameter STORE_W    = 10,         // 2^STORE_W words of store, at least 16
    parameter LANE_W     = 1,          // bits of a lane's number in an access of the host
    parameter INDEX      = 0,          // this lane's number
    parameter CHAIN      = 1,
    parameter SLEEP      = 1,
    parameter FLAGS      = 1,
    parameter STATUS     = 1,
    parameter LATENCY    = 12,         // of the arithmetic: operands to value_i, at least 3
    parameter ISSUE_W    = 1,
    parameter RETIRE_W   = 1,
    parameter HOST_W     = 1
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // What the sequencer says, and the same a cycle later
    input  wire [ISSUE_W-1:0]   issue_i,
    input  wire [RETIRE_W-1:0]  retire_i,
    input  wire [HOST_W-1:0]    host_i,
    input  wire [31:0]          data_i,         // the number of the step; for the host: its word
    output wire [ISSUE_W-1:0]   issue_o,
    output wire [RETIRE_W-1:0]  retire_o,
    output wire [HOST_W-1:0]    host_o,
    output wire [31:0]          data_o,
    // What it hears, gathered from lane to lane
    input  wire [STORE_W-3:0]   count_i,        // the most objects that a lane will visit
    input  wire [4:0]           flags_i,        // exceptions
    input  wire                 asleep_i,       // no lane before has this context awake
    input  wire [31:0]          answer_i,       // to the host, five cycles after host_i
    output wire [STORE_W-3:0]   count_o,
    output wire [4:0]           flags_o,
    output wire                 asleep_o,
    output wire [31:0]          answer_o,
    output wire                 report_o,       // asleep_o is news, about ...
    output wire                 report_batch_o,
    output wire [CONTEXT_W-1:0] report_context_o,
    // The arithmetic: z +/- x * y
    output wire                 subtract_o,
    output wire                 twice_o,        // what x is multiplied with, where y is not in the way
    output wire                 half_o,
    output wire [3:0]           kind_o,         // gen/choices.vh: z is what fp_value makes of z, x and y
    output wire [31:0]          x_o,
    output wire [31:0]          y_o,
    output wire [31:0]          z_o,
    input  wire [31:0]          value_i,
    input  wire [4:0]           value_flags_i,
    // Trace: an instruction ends, for its object: 1 there is none, 2 it sleeps, 3 executed ...
    output wire [1:0]            written_end_o,
    // ... and a register is written
    output wire                  written_o,
    output wire [CONTEXT_W-1:0]  written_context_o,
    output wire [STORE_W-4:0]    written_row_o,
    output wire [REGISTER_W-1:0] written_register_o,
    output wire [31:0]           written_value_o,
    output wire [4:0]            written_flags_o
);
`include "host/lane_host.vh"
    localparam REG_W = CONTEXT_W + REGISTER_W;
    localparam ROW_W = STORE_W - 3;            // a record has 8 words at least
    localparam [LANE_W-1:0]    ME     = INDEX;
    localparam [CONTEXT_W-1:0] SHARED = CONTEXTS[CONTEXT_W-1:0];

    // Said in this cycle, and to the next lane ---------------------------------------------------
    reg [ISSUE_W-1:0]  issue_q;
    reg [RETIRE_W-1:0] retire_q;
    reg [HOST_W-1:0]   host_q;
    reg [31:0]         data_q;
    always @(posedge clk_i) begin
        {issue_q, retire_q, host_q} <= {issue_i, retire_i, host_i} & {ISSUE_W+RETIRE_W+HOST_W{!rst_i}};
        data_q                      <= data_i;
    end
    assign {issue_o, retire_o, host_o, data_o} = {issue_q, retire_q, host_q, data_q};

    wire [3:0]            kind;
    wire                  subtract, twice, half, one, zero, st, st_lasts;
    wire [CONTEXT_W-1:0]  st_context;
    wire [REGISTER_W-1:0] st_register;
    wire [REG_W-1:0]      x_register, y_register, z_register;
    assign {kind, subtract, twice, half, one, zero, st, st_lasts, st_context, st_register, x_register, y_register, z_register} = issue_q;

    wire               host, host_write;
    wire [2:0]         host_kind;
    wire [LANE_W-1:0]  host_lane;
    wire [STORE_W-1:0] host_address;
    assign {host, host_write, host_kind, host_lane, host_address} = host_q;
    wire mine       = host && (host_lane == ME || host_kind == HOST_CONSTANT);
    wire mine_write = mine && host_write;

    // The same instruction later: _6 is V-6, _0 is V -----------------------------------------------
    wire                  round_6, valid_6, begins_6;
    wire [6:0]            rest_6;
    wire [CONTEXT_W-1:0]  context_6, context_4, context_1, context_0;
    wire [REGISTER_W-1:0] register_6, register_3, register_0;
    wire [1:0]            record;              // a record has 8 << record words
    wire                  take_4, valid_0, begins_0, ends_0, lasts_0, lds_0, sleep_0, load_0, arithmetic_0, batch_0;
    assign {record, round_6, valid_6, begins_6, rest_6, context_6, register_6} = retire_q;
    delay #(.W(1+CONTEXT_W), .N(2)) u_4 (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({valid_6 && begins_6, context_6}), .q_o({take_4, context_4}));
    delay #(.W(CONTEXT_W), .N(3)) u_context_1 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_4), .q_o(context_1));
    delay #(.W(CONTEXT_W), .N(1)) u_context_0 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_1), .q_o(context_0));
    delay #(.W(REGISTER_W), .N(3)) u_register_3 (.clk_i(clk_i), .rst_i(1'b0), .d_i(register_6), .q_o(register_3));
    delay #(.W(REGISTER_W), .N(3)) u_register_0 (.clk_i(clk_i), .rst_i(1'b0), .d_i(register_3), .q_o(register_0));
    delay #(.W(9), .N(6)) u_0 (.clk_i(clk_i), .rst_i(rst_i), .d_i({valid_6, begins_6, rest_6}),
        .q_o({valid_0, begins_0, ends_0, lasts_0, lds_0, sleep_0, load_0, arithmetic_0, batch_0}));

    // Operands -------------------------------------------------------------------------------------
    reg              write_q;                  // V+1
    reg  [REG_W-1:0] write_register_q;
    reg  [31:0]      write_value_q;
    wire [31:0]      x, y, z;
    ram_registered #(.ADDR_W(REG_W)) u_x (.clk_i(clk_i), .write_i(write_q && !rst_i),
        .write_addr_i(write_register_q), .write_value_i(write_value_q),
        .read_i(1'b1), .read_addr_i(x_register), .read_value_o(x));
    ram_registered #(.ADDR_W(REG_W)) u_y (.clk_i(clk_i), .write_i(write_q && !rst_i),
        .write_addr_i(write_register_q), .write_value_i(write_value_q),
        .read_i(1'b1), .read_addr_i(y_register), .read_value_o(y));
    generate
        if (CHAIN != 0) begin : g_z
            ram_registered #(.ADDR_W(REG_W)) u_z (.clk_i(clk_i), .write_i(write_q && !rst_i),
                .write_addr_i(write_register_q), .write_value_i(write_value_q),
                .read_i(1'b1), .read_addr_i(z_register), .read_value_o(z));
        end else begin : g_no_z
            // No instruction has both: z is where y is.
            wire unused = |z_register;
            assign z = y;
        end
    endgenerate

    // A sum is z +/- x * 1 (or 2, 1/2), a product -0 + x * y: the same bits and flags as without
    // the detour.
    wire       twice_2, half_2, one_2, zero_2;
    reg [31:0] x_q, y_q, z_q;
    delay #(.W(4), .N(2)) u_force (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({twice, half, one, zero}), .q_o({twice_2, half_2, one_2, zero_2}));
    delay #(.W(2), .N(1)) u_scale (.clk_i(clk_i), .rst_i(1'b0), .d_i({twice_2, half_2}), .q_o({twice_o, half_o}));
    delay #(.W(5), .N(3)) u_subtract (.clk_i(clk_i), .rst_i(1'b0), .d_i({kind, subtract}), .q_o({kind_o, subtract_o}));
    always @(posedge clk_i) begin
        x_q <= x;
        if (one_2)  y_q <= {1'b0, twice_2, {6{!twice_2}}, !twice_2 && !half_2, 23'd0};
        else        y_q <= y;
        if (zero_2) z_q <= 32'h80000000;
        else        z_q <= z;
    end
    assign {x_o, y_o, z_o} = {x_q, y_q, z_q};

    // sleep: |y| < x, compared as integers, which the magnitudes of numbers may be.
    wire less_0;
    generate
        if (SLEEP != 0) begin : g_less
            reg less_q;
            always @(posedge clk_i)
                less_q <= y_q[30:0] < x_q[30:0] && !x_q[31] && x_q[30:0] <= 31'h7f800000;
            delay #(.W(1), .N(LATENCY-1)) u_less (.clk_i(clk_i), .rst_i(1'b0), .d_i(less_q), .q_o(less_0));
        end else begin : g_no_less
            assign less_0 = 1'b0;
        end
    endgenerate

    // Whose turn it is -----------------------------------------------------------------------------
    wire [ROW_W-1:0] row_3, row_late, st_row;
    wire             executed, sleeps, absent, st_absent, st_asleep, asleep;
    wire [31:0]      stored_0;                 // the store's word
    reg              nonzero_q;                // V+1
    always @(posedge clk_i) nonzero_q <= |stored_0;
    wire [ROW_W:0]   count;
    visits #(.CONTEXT_W(CONTEXT_W), .ROW_W(ROW_W), .SLEEP(SLEEP)) u_visits (
        .clk_i(clk_i), .rst_i(rst_i), .round_i(round_6), .take_i(valid_6 && begins_6),
        .take_4_i(take_4), .context_4_i(context_4), .row_o(row_3), .row_late_o(row_late),
        .context_1_i(context_1), .valid_i(valid_0), .begins_i(begins_0), .ends_i(ends_0),
        .lasts_i(lasts_0), .lds_i(lds_0), .sleep_i(sleep_0), .context_i(context_0),
        .less_i(less_0), .executed_o(executed), .absent_o(absent), .sleeps_o(sleeps), .nonzero_i(nonzero_q), .asleep_o(asleep),
        .st_context_i(st_context), .st_row_o(st_row), .st_absent_o(st_absent), .st_asleep_o(st_asleep),
        .host_count_i(mine_write && host_kind == HOST_AWAKE),
        .host_wake_i(mine_write && host_kind == HOST_WAKE),
        .host_data_i(data_q[ROW_W:0]), .count_o(count));

    // The store: written in cycle 4 ------------------------------------------------------------------
    wire                  st_2, st_lasts_2;
    wire [REGISTER_W-1:0] st_register_2;
    reg                   st_q, store_write_q;
    reg  [STORE_W-1:0]    st_address_q, store_write_address_q, store_read_address_q;
    reg  [31:0]           store_write_value_q;
    wire [STORE_W-1:0]    st_base = {st_row, 3'd0} << record;
    wire [STORE_W-1:0]    base    = {row_3, 3'd0} << record;
    delay #(.W(2+REGISTER_W), .N(2)) u_st (.clk_i(clk_i), .rst_i(rst_i), .d_i({st, st_lasts, st_register}),
        .q_o({st_2, st_lasts_2, st_register_2}));
    wire host_store = mine_write && host_kind == HOST_OBJECT;
    always @(posedge clk_i) begin
        st_q         <= !rst_i && st_2 && !st_absent && !(st_asleep && !st_lasts_2);
        st_address_q <= st_base | {{STORE_W-REGISTER_W{1'b0}}, st_register_2};
        store_write_q         <= !rst_i && (st_q || host_store);
        store_write_address_q <= host ? host_address : st_address_q;
        store_write_value_q   <= host ? data_q : y_q;
        store_read_address_q  <= host ? host_address : base | {{STORE_W-REGISTER_W{1'b0}}, register_3};
    end
    ram_registered #(.ADDR_W(STORE_W)) u_store (.clk_i(clk_i), .write_i(store_write_q && !rst_i),
        .write_addr_i(store_write_address_q), .write_value_i(store_write_value_q),
        .read_i(1'b1), .read_addr_i(store_read_address_q), .read_value_o(stored_0));

    // A result: written in V+1 ------------------------------------------------------------------------
    wire host_constant = mine_write && host_kind == HOST_CONSTANT;
    wire writes        = (executed && (arithmetic_0 || load_0)) || sleeps;
    wire raises        = FLAGS != 0 && executed && arithmetic_0;
    reg  retired_q, raises_q;
    reg  [1:0] end_q;
    reg  [4:0] value_flags_q;
    always @(posedge clk_i) begin
        retired_q        <= !rst_i && writes;
        end_q            <= rst_i || !valid_0 ? 2'd0 : absent ? 2'd1 : executed ? 2'd3 : 2'd2;
        write_q          <= !rst_i && (writes || host_constant);
        write_register_q <= host_constant ? {SHARED, host_address[REGISTER_W-1:0]} : {context_0, register_0};
        write_value_q    <= arithmetic_0 ? value_i : load_0 ? stored_0 : data_q;
        value_flags_q    <= value_flags_i;
        raises_q         <= raises;
    end

    // The status of objects: {step of the first invalid or overflow, exceptions} ----------------------
    wire [31:0] status_0;
    generate
        if (STATUS != 0) begin : g_status
            wire [ROW_W-1:0] row_0;
            reg              status_write_q;
            reg  [ROW_W-1:0] row_2_q, status_address_q;
            reg  [31:0]      status_value_q;
            wire             fails = status_0[31:5] == 27'd0 && (value_flags_i[4] || value_flags_i[2]);
            delay #(.W(ROW_W), .N(2)) u_row_0 (.clk_i(clk_i), .rst_i(1'b0), .d_i(row_2_q), .q_o(row_0));
            always @(posedge clk_i) begin
                row_2_q          <= host ? host_address[ROW_W-1:0] : row_3;
                status_write_q   <= !rst_i && (raises || (mine_write && host_kind == HOST_STATUS));
                status_address_q <= host ? host_address[ROW_W-1:0] : row_0;
                status_value_q   <= host ? data_q : {fails ? data_q[26:0] : status_0[31:5],
                                                     status_0[4:0] | value_flags_i};
            end
            ram_registered #(.ADDR_W(ROW_W)) u_status (.clk_i(clk_i), .write_i(status_write_q && !rst_i),
                .write_addr_i(status_address_q), .write_value_i(status_value_q),
                .read_i(1'b1), .read_addr_i(row_2_q), .read_value_o(status_0));
        end else begin : g_no_status
            assign status_0 = 32'd0;
        end
    endgenerate

    // What the sequencer hears -------------------------------------------------------------------------
    wire [2:0] kind_3;
    wire       mine_3;
    reg  [ROW_W:0] count_q;
    reg  [4:0]     flags_q;
    reg  [31:0]    answer_q;
    reg            asleep_q;           // V+3
    delay #(.W(4), .N(3)) u_host (.clk_i(clk_i), .rst_i(1'b0), .d_i({mine, host_kind}), .q_o({mine_3, kind_3}));
    always @(posedge clk_i) begin
        count_q  <= count > count_i ? count : count_i;
        flags_q  <= flags_i | written_flags_o;
        answer_q <= !mine_3 ? answer_i : kind_3 == HOST_OBJECT ? stored_0
                  : kind_3 == HOST_STATUS ? status_0 : {{31-ROW_W{1'b0}}, count};
        asleep_q <= asleep_i && asleep;
    end
    assign {count_o, flags_o, answer_o, asleep_o} = {count_q, flags_q, answer_q, asleep_q};
    delay #(.W(2+CONTEXT_W), .N(3)) u_report (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({valid_0 && (sleep_0 || lds_0), batch_0, context_0}),
        .q_o({report_o, report_batch_o, report_context_o}));

    assign written_end_o     = end_q;
    assign written_o         = retired_q;
    assign written_row_o     = row_late;
    assign written_value_o   = write_value_q;
    assign written_flags_o   = value_flags_q & {5{raises_q}};
    assign {written_context_o, written_register_o} = write_register_q;
endmodule
`default_nettype wire
