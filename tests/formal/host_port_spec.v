// host_port_spec: promises of fp3_host_port.v, for every request: what a request registers comes alone.
`default_nettype none
`include "host/answer.vh"
`include "gen/settings.vh"
`include "gen/events.vh"
module host_port_spec #(
    parameter LEMMAS = 1,
`include "config/config.vh"
) (
    input wire         clk_i,
    input wire         rst_i,
    input wire         req_valid_i, req_write_i,
    input wire [23:0]  req_addr_i,
    input wire [31:0]  req_wdata_i, rdata_i,
    input wire         running_i, illegal_i, half_i, overfull_i, no_room_i, raised_i,
    input wire [PROGRAM_W-1:0] illegal_pc_i,
    input wire [4:0]   flags_i,
    input wire [`FP3_EVENTS_W-1:0] events_i
);
`include "gen/registers.vh"
`include "host/lane_host.vh"
    localparam FAR = MEMORY_LATENCY + 3;                   // cycles from a request to the word of a memory
    `FP3_SETTINGS_FIELDS
    `FP3_ANSWER_FIELDS
    wire [`FP3_SETTINGS_W-1:0] settings;
    wire [`FP3_ANSWER_W-1:0]   answer;
    assign `FP3_SETTINGS = settings;
    assign `FP3_ANSWER   = answer;
    wire        irq, start, stop, program_write, access, write;
    wire [2:0]  space;
    wire [19:0] addr;
    wire [31:0] wdata;
    wire [PROGRAM_W-1:0] program_addr;
    fp3_host_port #(.CONFIG(CONFIG)) u_host_port (.clk_i(clk_i), .rst_i(rst_i), .req_valid_i(req_valid_i), .req_write_i(req_write_i),
        .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i), .answer_o(answer), .irq_o(irq), .start_o(start), .stop_o(stop), .settings_o(settings),
        .running_i(running_i), .illegal_i(illegal_i), .illegal_pc_i(illegal_pc_i), .half_i(half_i), .overfull_i(overfull_i), .no_room_i(no_room_i),
        .raised_i(raised_i), .flags_i(flags_i), .events_i(events_i), .program_write_o(program_write), .program_addr_o(program_addr),
        .access_o(access), .write_o(write), .space_o(space), .addr_o(addr), .wdata_o(wdata), .rdata_i(rdata_i));
    (* hierconn *) wire       \u_host_port.ours , \u_host_port.in_memory , \u_host_port.g_counters.u_counters.clear_i ;
    (* hierconn *) wire [2:0] \u_host_port.space ;

    // The requests of the last cycles, which of them are reads of the port's own, and when one was alone
    reg         started_q = 1'b0, reset_q;
    reg [1:0]   any_q, write_q;
    reg [23:0]  addr_1q, addr_2q;
    reg [31:0]  data_1q, data_2q;
    reg [2:0]   own_q;                                     // such a read, two to four cycles ago
    reg [FAR:2] far_q;                                     // any other read
    reg [8:0]   alone_q;                                   // a request that is alone, one or more cycles ago
    reg [FAR:0] recent_q;                                  // requests
    wire        alone = any_q[0] && (\u_host_port.ours || (\u_host_port.in_memory && \u_host_port.space == HOST_CONSTANT));
    wire        taken = answer_wrote && !answer_write_error;
    wire        to_control = taken && addr_2q == ADDR_CONTROL;
    reg         starts_q, goes_q, taken_q;
    reg [3:0]   status_q;                                  // a read of `status`
    reg [`FP3_SETTINGS_W-1:0] settings_q;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        any_q    <= rst_i ? 2'd0 : {any_q[0], req_valid_i};
        write_q  <= {write_q[0], req_write_i};
        {addr_2q, addr_1q, data_2q, data_1q} <= {addr_1q, req_addr_i, data_1q, req_wdata_i};
        own_q    <= rst_i ? 3'd0 : {own_q[1:0], any_q[0] && !write_q[0] && \u_host_port.ours };
        far_q    <= rst_i ? 0 : {far_q[FAR-1:2], any_q[0] && !write_q[0] && !\u_host_port.ours };
        alone_q  <= rst_i ? 9'd0 : {alone_q[7:0], alone};
        recent_q <= rst_i ? 0 : {recent_q[FAR-1:0], req_valid_i};
        status_q <= rst_i ? 4'd0 : {status_q[2:0], req_valid_i && !req_write_i && req_addr_i == ADDR_STATUS};
        starts_q <= !rst_i && to_control && data_2q[CONTROL_START_LO];
        goes_q   <= !rst_i && to_control && data_2q[CONTROL_START_LO] && setting_steps != 0;
        taken_q  <= taken && !rst_i;
        settings_q <= settings;
    end
    always @* begin
        assume (started_q || rst_i);
        assume (!alone || (recent_q[FAR:1] == 0 && !req_valid_i));                         // all before it are answered
        assume (alone_q == 0 || !req_valid_i);
        assume (req_addr_i < 1 << (SPACE_BIT + 2));                                        // fp3 gives no others
        assume (!(alone || alone_q[3:0] != 0) || {req_addr_i, req_wdata_i, req_write_i} == {addr_1q, data_1q, write_q[0]});
    end
    always @* if (started_q && !reset_q && !rst_i) begin
        // One answer each, in order: a write's when it is executed, a read's when there is a word
        assert (answer_wrote == (any_q[1] && write_q[1]));
        assert (answer_read == (own_q[2] || far_q[FAR]) && !(own_q[2] && far_q[FAR]));
        // What is refused changes nothing
        if (settings != settings_q)                   assert (taken_q);
        if (access && write)                          assert (taken);
        if (program_write)                            assert (taken);
        assert (stop == (to_control && data_2q[CONTROL_STOP_LO] && running_i));
        // A start begins a run, unless it has no steps, and clears the counters, also without steps
        assert (start == goes_q);
        assert (\u_host_port.g_counters.u_counters.clear_i == starts_q);
        // One reason
        if (status_q[3]) assert (answer_read && !answer_read_error
                                 && {1'b0, answer_rdata[STATUS_ILLEGAL_LO]} + answer_rdata[STATUS_STOPPED_LO] + answer_rdata[STATUS_NO_ROOM_LO] <= 2'd1);
    end

    (* hierconn *) wire \u_host_port.illegal_q , \u_host_port.stopped_q , \u_host_port.no_room_q ;
    (* hierconn *) wire [MEMORY_LATENCY-1:0] \u_host_port.u_fetched.genblk1.g_many.d_q ;
    integer k;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert ({1'b0, \u_host_port.illegal_q } + \u_host_port.stopped_q + \u_host_port.no_room_q <= 2'd1);
                for (k = 0; k < MEMORY_LATENCY; k = k + 1) assert (\u_host_port.u_fetched.genblk1.g_many.d_q [k] == far_q[k+3]);
                for (k = 2; k <= FAR; k = k + 1) assert (!far_q[k] || recent_q[k-1]);
                for (k = 0; k < 3; k = k + 1) assert (!own_q[k] || alone_q[k]);
                for (k = 0; k < 9; k = k + 1) assert (!alone_q[k] || (recent_q & ~({{FAR{1'b0}}, 1'b1} << (k+1))) == 0);
                assert (any_q == recent_q[1:0]);
            end
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
