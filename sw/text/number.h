/* number.h - numbers as text, whatever the locale of the calling program. fp3/asm.h has
 * fp3_number_text. */
#ifndef FP3_NUMBER_H
#define FP3_NUMBER_H

#include <locale.h>

#include "token.h"

/* A program may have set a locale that reads 0.5 as 0 and writes 0,5. Between enter and leave this
 * thread has the locale "C". */
typedef struct {
    locale_t c, before;
} fp3_number_locale;
fp3_number_locale fp3_number_locale_enter(void);
void fp3_number_locale_leave(fp3_number_locale locale);

/* The token with a NUL behind it. NULL, or what is expected instead of the token. */
enum { FP3_NUMBER_SIZE = 256 };
const char *fp3_number_copy(fp3_token token, char text[FP3_NUMBER_SIZE]);

#endif
