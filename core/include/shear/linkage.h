/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/linkage.h
 * Declare functions of C to a compiler of C or C++: between SHEAR_BEGIN_C and SHEAR_END_C.
 */
#ifndef SHEAR_LINKAGE_H
#define SHEAR_LINKAGE_H

#ifdef __cplusplus
/** Begin declarations of C. */
#define SHEAR_BEGIN_C extern "C" {
/** End them. */
#define SHEAR_END_C }
#else
#define SHEAR_BEGIN_C
#define SHEAR_END_C
#endif

#endif
