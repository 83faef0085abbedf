// SPDX-License-Identifier: Apache-2.0
// config.vh: the keys of a configuration. Included at the end of the parameter list of every module
// that depends on it, so that only CONFIG is handed on:
//
//     module lane #(
//         parameter INDEX = 0,
//     `include "config/config.vh"
//     ) ( ...
//     lane #(.CONFIG(CONFIG)) u_lane ( ...
//
// The other names follow from CONFIG (derived.vh) and are not to be set. A module uses the
// names that it needs.
// verilator lint_off UNUSEDPARAM
`define FP3_OF_CONFIG
`include "gen/parameters.vh"
`undef FP3_OF_CONFIG
,
`include "config/derived.vh"
// verilator lint_on UNUSEDPARAM
