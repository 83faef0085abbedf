/* fp3/image.h - a program as the hardware takes it: code, constants, names of registers.
 *
 *     fp3_image *image = NULL;
 *     fp3_error error;
 *     if (fp3_image_load("ship.fp3", &image, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("v is register %u\n", fp3_image_find(image, "v", FP3_CLASSES_OBJECT)->index);
 *     fp3_image_free(&image);
 *
 * An image that the library hands out has passed every check below and is never changed again.
 *
 * As a file (*.fp3) it is 32-bit words, low byte first:
 *     0  magic            1  revision of the instruction set     2  words in all, the last included
 *     3  code words       4  step     5  last     6  constants   7  symbols
 *     8  object registers used | shared constants used << 16
 *     then the code, {index, bits} of each constant by index, {class << 24 | index, name in eight
 *     words padded with NULs} of each symbol by class, index and name,
 *     and last the CRC-32 (as in zlib) of all before. An image has this one form only.
 *
 * Threads: any number of threads may read an image at the same time.
 */
#ifndef FP3_IMAGE_H
#define FP3_IMAGE_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

#define FP3_IMAGE_MAGIC 0x49335046u /* "FP3I" as bytes */
#define FP3_IMAGE_CODE_LIMIT 65536u /* words: a program counter has 16 bits */
#define FP3_IMAGE_LABEL_LIMIT 1024u
#define FP3_NAME_SIZE 32 /* bytes of a name, its NUL included */
#define FP3_IMAGE_HEADER_WORDS 9
#define FP3_IMAGE_CONSTANT_WORDS 2 /* of the file, for each constant */
#define FP3_IMAGE_SYMBOL_WORDS (1 + FP3_NAME_SIZE / 4)

/* What a name stands for. The host writes state, param and shared, and reads state back. */
typedef enum {
    FP3_SYMBOL_STATE,  /* object register */
    FP3_SYMBOL_PARAM,  /* object register */
    FP3_SYMBOL_TEMP,   /* object register */
    FP3_SYMBOL_SHARED, /* shared constant without a value: the host gives it */
    FP3_SYMBOL_CONST,  /* shared constant with a value in the image */
    FP3_SYMBOL_LABEL,  /* index of a code word; code_count is possible */
    FP3_SYMBOL_CLASSES
} fp3_symbol_class;

/* Sets of classes, for fp3_image_find. */
#define FP3_CLASS(symbol_class) (1u << (symbol_class))
#define FP3_CLASSES_OBJECT                                                                         \
    (FP3_CLASS(FP3_SYMBOL_STATE) | FP3_CLASS(FP3_SYMBOL_PARAM) | FP3_CLASS(FP3_SYMBOL_TEMP))
#define FP3_CLASSES_SHARED (FP3_CLASS(FP3_SYMBOL_SHARED) | FP3_CLASS(FP3_SYMBOL_CONST))
#define FP3_CLASSES_HOST                                                                           \
    (FP3_CLASS(FP3_SYMBOL_STATE) | FP3_CLASS(FP3_SYMBOL_PARAM) | FP3_CLASS(FP3_SYMBOL_SHARED))
#define FP3_CLASSES_ALL (FP3_CLASS(FP3_SYMBOL_CLASSES) - 1)

/* Two names that mean the same in every program. `h` is the time step, one for all objects. `steps`
 * is how many steps an object has made, as an FP32 number: a program that has it adds 1 in each step,
 * and an engine refuses to run it beyond FP3_STEPS_LIMIT. What the host gives by these names can only
 * be a .shared and a .state. */
#define FP3_NAME_STEP "h"
#define FP3_NAME_STEPS "steps"
#define FP3_STEPS_LIMIT 16777216 /* 2^24: FP32 has no 2^24 + 1 */

typedef struct {
    fp3_symbol_class symbol_class;
    uint32_t index; /* 0..63 within its bank, or a code word's index */
    char name[FP3_NAME_SIZE];
} fp3_symbol;

typedef struct {
    uint32_t index; /* of the shared constant, 0..63 */
    uint32_t bits;  /* of its FP32 value */
} fp3_constant;

/* A run executes code[0..step) once, code[step..last) once a step, code[last..code_count) once. */
typedef struct {
    uint32_t code_count, step, last;
    uint32_t constant_count, symbol_count;
    uint32_t registers; /* object registers that code or names use: the highest index + 1 */
    uint32_t shared;    /* shared constants that code, names or values use, likewise */
    const uint32_t *code;
    const fp3_constant *constants; /* by index */
    const fp3_symbol *symbols;     /* by class, then index */
} fp3_image;

/* One instruction, operands as numbered in the word: shared constant k is FP3_BANK_SHARED_BASE + k.
 * Operands that the operation does not have are 0. */
typedef struct {
    uint32_t op; /* FP3_OP_ADD, ... of fp3/isa.h */
    uint32_t d, a, b, c;
} fp3_instruction;

/* FP3_E_PROGRAM for a word that the hardware refuses: an unknown opcode, or an operand that the
 * operation does not have and that is not 0. instruction may be NULL. */
fp3_status fp3_word_decode(uint32_t word, fp3_instruction *instruction, fp3_error *error);
/* The inverse. Checks nothing: what does not fit its field is cut. */
uint32_t fp3_word_encode(const fp3_instruction *instruction);

/* A checked copy of the draft, which stays the caller's, as *image does: fp3_image_free. registers
 * and shared are counted (the draft's are ignored), constants and symbols sorted.
 * Refused: step < last <= code_count <= FP3_IMAGE_CODE_LIMIT not held, an index out of its bank, a
 * malformed or a double name, two names or two values for one register, a .const without a value or
 * a .shared with one, a .param `steps` or a .state `h`, sleep and lds with different destinations or with a .param or .temp. Illegal
 * code words are let through: they are an engine's to refuse. */
fp3_status fp3_image_make(const fp3_image *draft, fp3_image **image, fp3_error *error);
/* Sets *image to NULL; that it was NULL before does no harm. */
void fp3_image_free(fp3_image **image);

/* From and to the words of a .fp3 file. The caller frees *image with fp3_image_free, *words with
 * free; count is of words. FP3_E_PROGRAM: the words are no image of this revision, or damaged. */
fp3_status fp3_image_decode(const uint32_t *words, size_t count, fp3_image **image,
                            fp3_error *error);
fp3_status fp3_image_encode(const fp3_image *image, uint32_t **words, size_t *count,
                            fp3_error *error);

/* Likewise with a file. Messages begin with the path. After a failed save the file is what it was
 * (or not there). A missing or forbidden file is FP3_E_ARGUMENT, a failing device FP3_E_SYSTEM. */
fp3_status fp3_image_load(const char *path, fp3_image **image, fp3_error *error);
fp3_status fp3_image_save(const fp3_image *image, const char *path, fp3_error *error);

/* What the next three give belongs to the image.
 * The symbol of this name if it is of one of these classes, or NULL. Names are unique in an image. */
const fp3_symbol *fp3_image_find(const fp3_image *image, const char *name, unsigned classes);
/* The name of a register or constant as numbered in a word, or NULL. */
const char *fp3_image_name(const fp3_image *image, uint32_t operand);
/* The FP32 bits that the image gives shared constant index, or NULL. */
const uint32_t *fp3_image_value(const fp3_image *image, uint32_t index);
/* The object register that sleep writes and lds reads, or -1 in a program without them. */
int fp3_image_slept(const fp3_image *image);
/* The object register that counts the object's steps, FP3_NAME_STEPS, or -1. */
int fp3_image_steps(const fp3_image *image);
/* "state" and so on; "?" for what is no class. */
const char *fp3_class_name(fp3_symbol_class symbol_class);
/* Whether the class names object registers. */
int fp3_class_is_object(fp3_symbol_class symbol_class);
/* Whether text is a name: a letter or _, then letters, digits or _, 31 characters at most, and not
 * one of the words that mean something by themselves: first, step, last, inf, nan. */
int fp3_name_valid(const char *text);
/* NULL, or what is expected instead of this name for a symbol of the class. */
const char *fp3_name_expected(const char *name, fp3_symbol_class symbol_class);

/* ---- assembly: text to image and back ----
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
