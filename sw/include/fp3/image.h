/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/image.h - a program as the hardware executes it: code, constants, names of registers.
 *
 *     fp3_image *image = NULL;
 *     fp3_error error;
 *     if (fp3_image_load("ship.fp3", &image, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("v is register %u\n", fp3_image_find(image, "v", FP3_CLASSES_OBJECT)->index);
 *     fp3_image_free(&image);
 *
 * An image that the library returns has passed every check below and never changes.
 *
 * A file (*.fp3) consists of 32-bit words, low byte first:
 *     0  magic            1  revision of the instruction set     2  number of words in the file
 *     3  code words       4  step     5  last     6  constants   7  symbols
 *     8  object registers used | shared constants used << 16 | words << 24
 * Then come the code; {index, bits} of each constant, sorted by index; {class << 24 | index, name
 * in eight words padded with NULs} of each symbol, sorted by class, index and name; and the CRC-32
 * (as in zlib) of everything before it. Each image has exactly one such file.
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
#define FP3_NAME_SIZE 32 /* bytes of a name, including its NUL */
#define FP3_IMAGE_HEADER_WORDS 9
#define FP3_IMAGE_CONSTANT_WORDS 2 /* words in the file for each constant */
#define FP3_IMAGE_SYMBOL_WORDS (1 + FP3_NAME_SIZE / 4)

/* What a name stands for. The host writes state, param and shared, and reads state back. */
typedef enum {
    FP3_SYMBOL_STATE,  /* object register */
    FP3_SYMBOL_PARAM,  /* object register */
    FP3_SYMBOL_TEMP,   /* object register */
    FP3_SYMBOL_SHARED, /* shared constant whose value the host writes */
    FP3_SYMBOL_CONST,  /* shared constant whose value is in the image */
    FP3_SYMBOL_LABEL,  /* index of a code word, or code_count */
    FP3_SYMBOL_WORST,  /* object register: behind a phase that stores it all objects have the worst
                        */
    FP3_SYMBOL_CLASSES
} fp3_symbol_class;

/* Sets of classes, for fp3_image_find. */
#define FP3_CLASS(symbol_class) (1u << (symbol_class))
#define FP3_CLASSES_OBJECT                                                                         \
    (FP3_CLASS(FP3_SYMBOL_STATE) | FP3_CLASS(FP3_SYMBOL_PARAM) | FP3_CLASS(FP3_SYMBOL_TEMP) |      \
     FP3_CLASS(FP3_SYMBOL_WORST))
#define FP3_CLASSES_SHARED (FP3_CLASS(FP3_SYMBOL_SHARED) | FP3_CLASS(FP3_SYMBOL_CONST))
#define FP3_CLASSES_HOST                                                                           \
    (FP3_CLASS(FP3_SYMBOL_STATE) | FP3_CLASS(FP3_SYMBOL_PARAM) | FP3_CLASS(FP3_SYMBOL_SHARED))
#define FP3_CLASSES_ALL (FP3_CLASS(FP3_SYMBOL_CLASSES) - 1)

/* Some names have the same meaning in every program. `h` is the time step of all objects: if the
 * host writes `h`, it must be a .shared. `steps` is the number of steps that an object has made, as
 * an FP32 number: if the host writes `steps`, it must be a .state. A program with `steps` adds 1 in
 * each step, and an engine refuses to run the program beyond FP3_STEPS_LIMIT. */
#define FP3_NAME_STEP "h"
#define FP3_NAME_STEPS "steps"
/* A state of this name counts how long its object has been at rest: from 1 on the object may fall
 * asleep with its island, and while it sleeps the state is -1 (docs/relations.md). */
#define FP3_NAME_REST "at_rest"
/* A state of this name is 0 while its object lives, and 1 after a step that ended its life: the
 * object makes no step then, and nobody sees it. The host may write 0 (docs/relations.md). */
#define FP3_NAME_REMOVED "is_removed"
#define FP3_STEPS_LIMIT 16777216 /* 2^24: FP32 cannot represent 2^24 + 1 */

typedef struct {
    fp3_symbol_class symbol_class;
    uint32_t index; /* 0..63 of a register or constant, or a code word's index */
    char name[FP3_NAME_SIZE];
} fp3_symbol;

typedef struct {
    uint32_t index; /* of the shared constant, 0..63 */
    uint32_t bits;  /* of its FP32 value */
} fp3_constant;

/* The arithmetic that a program is made for, by the configuration's keys: any; binary32;
 * logarithms; no subnormal numbers; Cell's SPU; truncated; truncated without subnormal numbers;
 * binary32 with exact rcp and rsqrt. */
typedef enum {
    FP3_WORDS_ANY,
    FP3_WORDS_FLOATS,
    FP3_WORDS_LOGARITHMS,
    FP3_WORDS_FLUSHED,
    FP3_WORDS_CELL,
    FP3_WORDS_TRUNCATED,
    FP3_WORDS_TRUNCATED_FLUSHED,
    FP3_WORDS_MIXED,
    FP3_WORDS_KINDS
} fp3_image_words;

/* fp3_image.words is a kind + FP3_WORDS_FEWER * (FP3_WORDS_FRACTION - the fraction bits of a
 * number). */
enum { FP3_WORDS_FEWER = 8, FP3_WORDS_FRACTION = 23, FP3_WORDS_FRACTION_LEAST = 7 };
enum { FP3_WORDS_NAME_SIZE = 64 };

/* A run executes code[0..step) once, code[step..last) once a step, code[last..code_count) once. */
typedef struct {
    uint32_t code_count, step, last;
    uint32_t constant_count, symbol_count;
    uint32_t words;     /* the arithmetic that the program is made for */
    uint32_t registers; /* object registers used by code or names: the highest index + 1 */
    uint32_t shared;    /* shared constants used by code, names or values: likewise */
    const uint32_t *code;
    const fp3_constant *constants;     /* sorted by index */
    const fp3_symbol *symbols;         /* sorted by class, then index */
    const struct fp3_decoded *decoded; /* each word of code; used by the library only */
} fp3_image;

/* One instruction. Operands are numbered as in the word: shared constant k is
 * FP3_BANK_SHARED_BASE + k. Operands that the operation does not have are 0. */
typedef struct {
    uint32_t op; /* FP3_OP_ADD, ... of fp3/isa.h */
    uint32_t d, a, b, c;
} fp3_instruction;

/* Decodes a word. FP3_E_PROGRAM: the hardware would refuse the word, because its opcode is unknown,
 * or an operand that the operation does not have is not 0. instruction may be NULL. */
fp3_status fp3_word_decode(uint32_t word, fp3_instruction *instruction, fp3_error *error);
/* The inverse. Checks nothing: a value too large for its field is truncated. */
uint32_t fp3_word_encode(const fp3_instruction *instruction);

/* "floats 7", "logarithms", as in the directive .words. Returns text, or NULL for unknown words. */
const char *fp3_image_words_name(uint32_t words, char text[FP3_WORDS_NAME_SIZE]);
/* The same for a message: "floats of 7 fraction bits". */
const char *fp3_image_words_said(uint32_t words, char text[FP3_WORDS_NAME_SIZE]);

/* Makes a checked copy of the draft, which the caller keeps. The caller frees *image with
 * fp3_image_free. The copy's registers, shared and decoded are computed (the draft's are ignored),
 * and its constants and symbols are sorted. FP3_E_PROGRAM: step < last <= code_count <=
 * FP3_IMAGE_CODE_LIMIT does not hold; unknown words; an index is out of range; a name is malformed
 * or used twice; a register has two names or two values; a .const has no value or a .shared has a
 * value; `h` or `steps` has a class other than above; sleep and lds have different destinations, or
 * a destination that is a .param or .temp. Illegal code words are not refused here, but by the
 * engines. */
fp3_status fp3_image_make(const fp3_image *draft, fp3_image **image, fp3_error *error);
/* Frees *image and sets it to NULL. *image may be NULL already. */
void fp3_image_free(fp3_image **image);

/* Convert from and to the words of a .fp3 file; count is in words. The caller frees *image with
 * fp3_image_free, and *words with free. FP3_E_PROGRAM: the words are not an image of this revision,
 * or are damaged. */
fp3_status fp3_image_decode(const uint32_t *words, size_t count, fp3_image **image,
                            fp3_error *error);
fp3_status fp3_image_encode(const fp3_image *image, uint32_t **words, size_t *count,
                            fp3_error *error);

/* The same with a file. Messages begin with the path. A failed save leaves the file as it was, or
 * absent. FP3_E_ARGUMENT: the file is missing or may not be accessed. FP3_E_SYSTEM: the device
 * failed. */
fp3_status fp3_image_load(const char *path, fp3_image **image, fp3_error *error);
fp3_status fp3_image_save(const fp3_image *image, const char *path, fp3_error *error);

/* The next functions take an image made by the library, not a draft. The first three return
 * pointers that belong to the image.
 * The symbol of this name if its class is in classes, else NULL. Names are unique. */
const fp3_symbol *fp3_image_find(const fp3_image *image, const char *name, unsigned classes);
/* The name of a register or constant, numbered as in a word, or NULL. */
const char *fp3_image_name(const fp3_image *image, uint32_t operand);
/* The FP32 bits that the image gives the shared constant of this index, or NULL. */
const uint32_t *fp3_image_value(const fp3_image *image, uint32_t index);
/* The object register that sleep writes and lds reads, or -1 if the program has neither. */
int fp3_image_slept(const fp3_image *image);
/* The object register that counts the object's steps, FP3_NAME_STEPS, or -1. */
int fp3_image_steps(const fp3_image *image);
/* The object register FP3_NAME_REST, or -1. */
int fp3_image_rest(const fp3_image *image);
/* The object register FP3_NAME_REMOVED, or -1. */
int fp3_image_removed(const fp3_image *image);
/* "state" and so on; "?" for an unknown class. */
const char *fp3_class_name(fp3_symbol_class symbol_class);
/* Whether the class names object registers. */
int fp3_class_is_object(fp3_symbol_class symbol_class);
/* Whether text is a valid name: a letter or _, then letters, digits or _, at most 31 characters,
 * and not one of the reserved words: first, step, last, inf, nan. */
int fp3_name_valid(const char *text);
/* NULL if a symbol of the class may have this name, else what is expected instead. */
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
    fp3_image *image;     /* NULL if the source has errors */
    uint32_t *lines;      /* the source line of each code word, from 1 */
    unsigned error_count; /* at most 20: then assembly stops */
    /* For each error "name:line:column: error: found 'x', expected y", the line and a caret. */
    char *report;
} fp3_assembly;

/* source has size bytes, needs no NUL and may hold any bytes. name appears in the report. The
 * caller frees *result and all its members with fp3_assembly_free. FP3_E_PROGRAM: the source has
 * errors; *result holds the report, and error its first line. After any other failure *result is
 * NULL. */
fp3_status fp3_assemble(const char *source, size_t size, const char *name, fp3_assembly **result,
                        fp3_error *error);
/* Frees *result and sets it to NULL. *result may be NULL already. */
void fp3_assembly_free(fp3_assembly **result);

/* The source with the index and the word of each instruction, then the meaning of each register.
 * The assembly must have an image, made from this source. The caller frees *text, which ends with a
 * NUL. */
fp3_status fp3_listing(const fp3_assembly *assembly, const char *source, size_t size, char **text,
                       fp3_error *error);

/* Text that assembles to an image that is identical in every bit. The caller frees *text, which
 * ends with a NUL. FP3_E_PROGRAM: a word is illegal. */
fp3_status fp3_disassemble(const fp3_image *image, char **text, fp3_error *error);

/* One instruction, such as "madd r3, k1, r2, r0", with the names of image unless that is NULL.
 * FP3_E_PROGRAM: the word is illegal; text is unchanged. */
#define FP3_WORD_TEXT_SIZE 160
fp3_status fp3_word_text(uint32_t word, const fp3_image *image, char text[FP3_WORD_TEXT_SIZE],
                         fp3_error *error);

/* Writes the words of the image's file as $readmemh text, each with its meaning as a comment. Fails
 * as fp3_image_save does. */
fp3_status fp3_image_save_hex(const fp3_image *image, const char *path, fp3_error *error);

/* A C header with the image's words, constants and names, for the driver of an FP3 in a design of
 * your own (sw/bare/fp3_bare.h). All its names begin with `name`, which must be valid
 * (fp3_name_valid). The caller frees *text, which ends with a NUL. FP3_E_PROGRAM: with its loads
 * and stores the program is too long. */
fp3_status fp3_image_header(const fp3_image *image, const char *name, char **text,
                            fp3_error *error);

/* The shortest text that the assembler reads as these FP32 bits. */
#define FP3_NUMBER_TEXT_SIZE 24
void fp3_number_text(uint32_t bits, char text[FP3_NUMBER_TEXT_SIZE]);

FP3_API_END

#endif
