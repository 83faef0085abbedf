/* SPDX-License-Identifier: Apache-2.0 */
/* argp.h - what the command uses of glibc's <argp.h>, which other C libraries do not have.
 *
 * Options by getopt_long. --help lists them, with what each one does in one line.
 */
#ifndef FP3_WASM_ARGP_H
#define FP3_WASM_ARGP_H

#include <errno.h>

typedef int error_t;

struct argp_option {
    const char *name;
    int key; /* below 256: its letter, too */
    const char *arg;
    int flags;
    const char *doc;
    int group;
};
#define OPTION_ARG_OPTIONAL 1

struct argp_state {
    int argc;
    char **argv;
    int next; /* the word that is read next */
    void *input;
};

#define ARGP_KEY_ARG 0
#define ARGP_KEY_END 0x1000001
#define ARGP_KEY_NO_ARGS 0x1000002
#define ARGP_ERR_UNKNOWN E2BIG
#define ARGP_IN_ORDER 8 /* options behind the first other word stay */

struct argp {
    const struct argp_option *options; /* ended by {0}; or NULL */
    error_t (*parser)(int key, char *text, struct argp_state *state);
    const char *args_doc; /* each line is a form */
    const char *doc;      /* before the options and, from a vertical tab on, behind them */
};

extern const char *argp_program_version;
extern int argp_err_exit_status;

error_t argp_parse(const struct argp *argp, int argc, char **argv, unsigned flags, int *index,
                   void *input);
_Noreturn void argp_usage(const struct argp_state *state);
__attribute__((format(printf, 2, 3))) _Noreturn void argp_error(const struct argp_state *state,
                                                                const char *format, ...);
__attribute__((format(printf, 4, 5))) _Noreturn void
argp_failure(const struct argp_state *state, int status, int number, const char *format, ...);

#endif
