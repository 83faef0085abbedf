/* SPDX-License-Identifier: Apache-2.0 */
/* install.h - where `make install` puts what libfp3 loads. */
#ifndef FP3_INSTALL_H
#define FP3_INSTALL_H

extern const char fp3_install_rtl_dir[];

#endif
