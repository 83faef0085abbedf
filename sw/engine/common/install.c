/* SPDX-License-Identifier: Apache-2.0 */
/* install.c - where `make install` puts what libfp3 loads; compiled for each place. */
#include "install.h"

#ifndef FP3_INSTALL_RTL_DIR
#define FP3_INSTALL_RTL_DIR "/usr/local/lib/fp3"
#endif

const char fp3_install_rtl_dir[] = FP3_INSTALL_RTL_DIR;
