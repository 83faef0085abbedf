// SPDX-License-Identifier: Apache-2.0
// bundles.vh: all bundles of a lane: what it is told, what goes on inside, what it answers, and
// what goes to its arithmetic and back.
`include "lane/around.vh"
`include "lane/reach.vh"
`include "lane/issue.vh"
`include "lane/retire.vh"
`include "lane/dual_issue.vh"
`include "lane/dual_retire.vh"
`include "lane/access.vh"
`include "lane/move.vh"
`include "lane/end.vh"
`include "lane/report.vh"
`include "lane/written.vh"
`include "unit/socket.vh"
// What goes from lane to lane in this configuration.
`define FP3_LANE_ISSUE_W (DUAL != 0 ? `FP3_DUAL_ISSUE_W : `FP3_ISSUE_W)
`define FP3_LANE_RETIRE_W (DUAL != 0 ? `FP3_DUAL_RETIRE_W : `FP3_RETIRE_W)
