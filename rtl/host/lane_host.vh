// SPDX-License-Identifier: Apache-2.0
// The spaces that the host accesses in a lane. Included inside modules.
// verilator lint_off UNUSEDPARAM
localparam [2:0] HOST_OBJECT   = 3'd0;   // a word of the store
localparam [2:0] HOST_STATUS   = 3'd1;   // a word of the objects' status
localparam [2:0] HOST_AWAKE    = 3'd2;   // the count of the list
localparam [2:0] HOST_WAKE     = 3'd3;   // one more on the list
localparam [2:0] HOST_CONSTANT = 3'd4;   // a shared constant: of all lanes
localparam [2:0] HOST_COPIES   = 3'd5;   // a word of the list of copies: of no lane
localparam [2:0] HOST_EVERY    = 3'd6;   // a word of the store, in all lanes
// verilator lint_on UNUSEDPARAM
