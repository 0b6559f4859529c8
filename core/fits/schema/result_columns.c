/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/schema/result_columns.h"

#define REAL(member)                 "D", offsetof(shear_row, member), 0, 0
#define INTEGER(member, shift, most) "J", offsetof(shear_row, member), shift, most

/* Pixel coordinates count from 1 in the file, 0 = none; the members count from 0, -1 = none. */
static const char artefact[] = "artefact's pixel, from 1; 0 = there is none";

const sf_member sf_catalog_members[SF_CATALOG_MEMBERS] = {
    {"N1", REAL(n1), "", "-(M20 - M02)/2, numerator of g1, pixel value^2"},
    {"N2", REAL(n2), "", "-M11, numerator of g2, pixel value^2"},
    {"D", REAL(d), "", "M20 + M02 - (beta^2/2) M4, denominator"},
    {"U", REAL(u), SF_PER_AREA, "sum of (kx^4 - 6 kx^2 ky^2 + ky^4) P"},
    {"V", REAL(v), SF_PER_AREA, "sum of (kx^3 ky - kx ky^3) P"},
    {"M20", REAL(m20), "", "sum of kx^2 P, pixel value^2"},
    {"M02", REAL(m02), "", "sum of ky^2 P, pixel value^2"},
    {"M11", REAL(m11), "", "sum of kx ky P, pixel value^2"},
    {"M4", REAL(m4), SF_PER_AREA, "sum of k^4 P, pixel value^2"},
    {"NOISE_N1", REAL(noise_n1), "", "N1 of the noise stamp alone"},
    {"NOISE_N2", REAL(noise_n2), "", "N2 of the noise stamp alone"},
    {"NOISE_D", REAL(noise_d), "", "D of the noise stamp alone"},
    {"HIGH_G", REAL(high_galaxy), "", "galaxy stamp's mean power at high k"},
    {"HIGH_N", REAL(high_noise), "", "noise stamp's mean power at high k"},
    {"FLUX", REAL(flux), "", "sum of galaxy minus noise, pixel values"},
    {"SNR", REAL(snr), "", "flux over its noise"},
    {"WEIGHT", REAL(weight), "", "weight in the sums of the field"},
    {"FLAGS", INTEGER(flags, 0, UINT32_MAX), "", "why it is left out; 0 = in the sums"},
    {"ART_X", INTEGER(artefact_x, 1, SHEAR_MAX_SIDE), "pixel", artefact},
    {"ART_Y", INTEGER(artefact_y, 1, SHEAR_MAX_SIDE), "pixel", artefact},
};

const char *const sf_flag_keywords[SHEAR_N_FLAGS] = {
    "NF_GAL",   "NF_NOISE", "NF_MASK", "NF_EMPTY", "NF_PSF",   "NF_WGHT",  "NF_RGAL",  "NF_OVER",
    "NF_ARTEF", "NF_NARTE", "NF_EDGE", "NF_HOLE",  "NF_SATUR", "NF_NEIGH", "NF_NONOI", "NF_NOPOS",
};
