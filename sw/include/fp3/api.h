/* fp3/api.h - what every header of the library begins and ends with: C linkage for C++, and names
 * that a shared library exports. All else in the library is hidden. */
#ifndef FP3_API_H
#define FP3_API_H

#define FP3_VERSION "0.1.0"

#ifdef __cplusplus
#define FP3_API_BEGIN                                                                              \
    extern "C" {                                                                                   \
    _Pragma("GCC visibility push(default)")
#define FP3_API_END                                                                                \
    _Pragma("GCC visibility pop")                                                                  \
    }
#else
#define FP3_API_BEGIN _Pragma("GCC visibility push(default)")
#define FP3_API_END _Pragma("GCC visibility pop")
#endif

#endif
