/* sample.h - objects with parameters from their ranges, and where each really is. */
#ifndef FP3_TUNE_SAMPLE_H
#define FP3_TUNE_SAMPLE_H

#include <fp3/tune.h>

typedef struct {
    const fp3_model *model;
    double times[FP3_TUNE_LOOKS];
    size_t count, room;
    /* A row for each object. */
    double *params, *initial, *sizes;
    double *truth, *slopes; /* FP3_TUNE_LOOKS rows of a number for each state */
} fp3_sample;

/* Ranges of the params: how many values are spread. */
uint32_t fp3_sample_ranges(const fp3_params *params);

void fp3_sample_open(fp3_sample *sample, const fp3_model *model, double span);
void fp3_sample_close(fp3_sample *sample);

/* Adds the object that lies at these shares, one for each range: 0 its first, 1 its last value. Parameters
 * and start are FP32 numbers. FP3_E_FAILED: it has no truth. */
fp3_status fp3_sample_add(fp3_sample *sample, const fp3_program *program, const fp3_params *params,
                          const double *shares, fp3_error *error);
/* Adds all objects of another one. */
fp3_status fp3_sample_join(fp3_sample *sample, const fp3_sample *other, fp3_error *error);

/* Where the object's state is at `late` behind a look: late is far less than a step. */
double fp3_sample_truth(const fp3_sample *sample, size_t object, unsigned look, uint32_t state,
                        double late);

#endif
