/* fp3/asm.h - assembly text to image and back.
 *
 *     fp3_assembly *result = NULL;
 *     if (fp3_assemble(text, strlen(text), "ship.s", &result, &error))
 *         fputs(result ? result->report : error.text, stderr);
 *     else
 *         fp3_image_save(result->image, "ship.fp3", &error);
 *     fp3_assembly_free(&result);
 *
 * docs/assembly.md describes the language.
 */
#ifndef FP3_ASM_H
#define FP3_ASM_H

#include <fp3/api.h>
#include <fp3/image.h>

FP3_API_BEGIN

typedef struct {
    fp3_image *image;     /* NULL when the source has errors */
    uint32_t *lines;      /* the source line of each code word, from 1 */
    unsigned error_count; /* assembly stops at the 20th */
    /* For each error "name:line:column: error: found 'x', expected y", the line and a caret. */
    char *report;
} fp3_assembly;

/* source has size bytes, needs no NUL and may hold any bytes; name is for the report. The caller
 * frees *result, and with it all that it holds. FP3_E_PROGRAM: the source is wrong; *result holds the
 * report, and error the report's first line. After any other failure *result is NULL. */
fp3_status fp3_assemble(const char *source, size_t size, const char *name, fp3_assembly **result,
                        fp3_error *error);
/* Sets *result to NULL, which it may be already. */
void fp3_assembly_free(fp3_assembly **result);

/* The source with the index and the word of each instruction, then what each register stands for. The
 * assembly must have an image, made from this source. The caller frees *text, which ends with a
 * NUL. */
fp3_status fp3_listing(const fp3_assembly *assembly, const char *source, size_t size, char **text,
                       fp3_error *error);

/* Text that assembles to an image identical in every bit. The caller frees *text, which ends with a
 * NUL. FP3_E_PROGRAM: a word is illegal. */
fp3_status fp3_disassemble(const fp3_image *image, char **text, fp3_error *error);

/* One instruction, as in "madd r3, k1, r2, r0", with the names of image unless that is NULL.
 * FP3_E_PROGRAM: the word is illegal; text is unchanged. */
#define FP3_WORD_TEXT_SIZE 160
fp3_status fp3_word_text(uint32_t word, const fp3_image *image, char text[FP3_WORD_TEXT_SIZE],
                         fp3_error *error);

/* The words of the image's file as $readmemh text, each with its meaning as a comment. Fails as
 * fp3_image_save does. */
fp3_status fp3_image_save_hex(const fp3_image *image, const char *path, fp3_error *error);

/* A C header with the image's words, constants and names for the driver of a processor of one's own
 * (sw/bare/fp3_bare.h); all its names begin with `name`, which must be a name (fp3_name_valid). The caller
 * frees *text, which ends with a NUL. FP3_E_PROGRAM: with its loads and stores it is too long. */
fp3_status fp3_image_header(const fp3_image *image, const char *name, char **text,
                            fp3_error *error);

/* The shortest number that the assembler reads as these FP32 bits. */
#define FP3_NUMBER_TEXT_SIZE 24
void fp3_number_text(uint32_t bits, char text[FP3_NUMBER_TEXT_SIZE]);

FP3_API_END

#endif
