/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/catalog/schema.h"

#include "shear/field.h"

const unsigned sf_catalog_copied[SF_CATALOG_COPIED] = {SHEAR_COL_ID, SHEAR_COL_X, SHEAR_COL_Y,
                                                       SHEAR_COL_RA, SHEAR_COL_DEC};

#define MEMBER(m) offsetof(shear_row, m)

const sf_member sf_catalog_members[SF_CATALOG_MEMBERS] = {
    {"N1", MEMBER(n1), "", "-(M20 - M02)/2, numerator of g1, pixel value^2"},
    {"N2", MEMBER(n2), "", "-M11, numerator of g2, pixel value^2"},
    {"D", MEMBER(d), "", "M20 + M02 - (beta^2/2) M4, denominator"},
    {"U", MEMBER(u), "pixel**-2", "sum of (kx^4 - 6 kx^2 ky^2 + ky^4) P"},
    {"V", MEMBER(v), "pixel**-2", "sum of (kx^3 ky - kx ky^3) P"},
    {"M20", MEMBER(m20), "", "sum of kx^2 P, pixel value^2"},
    {"M02", MEMBER(m02), "", "sum of ky^2 P, pixel value^2"},
    {"M11", MEMBER(m11), "", "sum of kx ky P, pixel value^2"},
    {"M4", MEMBER(m4), "pixel**-2", "sum of k^4 P, pixel value^2"},
    {"NOISE_N1", MEMBER(noise_n1), "", "N1 of the noise stamp alone"},
    {"NOISE_N2", MEMBER(noise_n2), "", "N2 of the noise stamp alone"},
    {"NOISE_D", MEMBER(noise_d), "", "D of the noise stamp alone"},
    {"HIGH_G", MEMBER(high_galaxy), "", "galaxy stamp's mean power at high k"},
    {"HIGH_N", MEMBER(high_noise), "", "noise stamp's mean power at high k"},
    {"FLUX", MEMBER(flux), "", "sum of galaxy minus noise, pixel values"},
    {"SNR", MEMBER(snr), "", "flux over its noise"},
    {"WEIGHT", MEMBER(weight), "", "weight in the sums of the field"},
};

const sf_place_member sf_catalog_places[SF_CATALOG_PLACES] = {
    {"ART_X", MEMBER(artefact_x), "artefact's pixel, from 1; 0 = there is none"},
    {"ART_Y", MEMBER(artefact_y), "artefact's pixel, from 1; 0 = there is none"},
};

const char *const sf_flag_keywords[SHEAR_N_FLAGS] = {
    "NF_GAL",  "NF_NOISE", "NF_MASK", "NF_EMPTY", "NF_PSF",
    "NF_WGHT", "NF_RGAL",  "NF_OVER", "NF_ARTEF", "NF_NARTE",
};
