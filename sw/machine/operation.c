#include "operation.h"

const fp3_operation fp3_operations[] = {FP3_OPERATION_ROWS};
const unsigned fp3_operation_count = sizeof fp3_operations / sizeof *fp3_operations;

const fp3_operation *fp3_operation_find(uint32_t code) {
    for (unsigned i = 0; i < fp3_operation_count; i++)
        if (fp3_operations[i].code == code)
            return &fp3_operations[i];
    return NULL;
}

int fp3_operation_is_arithmetic(const fp3_operation *operation) {
    return !(operation->path & (FP3_UNIT_STORE | FP3_UNIT_COMPARISON));
}

fp3_key fp3_operation_lacks(const fp3_config *config, uint32_t code) {
    const fp3_operation *operation = fp3_operation_find(code);
    if (!operation || operation->needs == FP3_KEY_NONE ||
        fp3_config_value(config, operation->needs))
        return FP3_KEY_NONE;
    return operation->needs;
}
