/* SPDX-License-Identifier: Apache-2.0 */
#include "number.h"

#include "base/number.h"

const char *fp3_ode_number(fp3_token t, double *value) {
    char text[FP3_NUMBER_SIZE];
    const char *expected = fp3_number_copy(t, text);
    return expected ? expected : fp3_number_decimal(text, value);
}
