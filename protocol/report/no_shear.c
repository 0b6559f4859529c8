/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/no_shear.h"

#include "base/text.h"
#include "report/advice_say.h"
#include "shear/symmetry.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

typedef struct reason {
    const char *name, *words, *advice;
} reason;

static const reason reasons[] = {
    [SHEAR_HAS_SHEAR] = {NULL, NULL, NULL},
    [SHEAR_NO_STAMPS] = {"too_few_stamps", "fewer than two usable stamps",
                         "two are needed; \"shearctl validate\" tells why stamps are left out"},
    [SHEAR_NO_WEIGHT] = {"no_weight", "all weights are 0", "correct the column WEIGHT"},
    [SHEAR_NO_DIFFERENCE] = {"same_stamps", "galaxy and noise stamps are the same",
                             "see which images are given as galaxies, and which as noise"},
    [SHEAR_NO_SIGNAL] = {"no_signal", "there is no signal",
                         "are there galaxies in the galaxy stamps? then more of them are needed, "
                         "or brighter ones"},
    [SHEAR_SWAPPED] = {"swapped", "the noise stamps have more power than the galaxies': swapped?",
                       "exchange galaxy and noise stamps, or correct what makes the noise stamps "
                       "brighter than the galaxies; of an exposure, see that its catalog is of "
                       "this image"},
    [SHEAR_TOO_NARROW] =
        {"too_narrow", "the galaxies look narrower than the PSF: is it that of this image?",
         "give the PSF of this image, made from its stars, and leave stars out; where the PSF has "
         "several samples per galaxy pixel, the keyword OVERSAMP; and stamps that are 10 beta "
         "wide"},
    [SHEAR_NO_SYMMETRY] = {"no_symmetry", "the stamps' symmetry has no solution",
                           "16 stamps are needed at least; or use --estimator mean"},
    [SHEAR_NO_FRAME] = {"mixed_frames", "its stamps were measured along different axes",
                        "retract what is not in the frame of the others, or measure all with one "
                        "--frame"},
    [SHEAR_NOT_FINITE] = {"not_finite", "the sums are beyond the range of double",
                          "scale the pixels, or the weights"},
};
enum { N_REASONS = sizeof reasons / sizeof reasons[0] };

static const reason *reason_of(enum shear_no_shear why) {
    return &reasons[(unsigned)why < N_REASONS ? why : SHEAR_HAS_SHEAR];
}

const char *sheard_no_shear_name(enum shear_no_shear why) {
    return reason_of(why)->name;
}

enum shear_no_shear sheard_no_shear_of(const char *name) {
    for (enum shear_no_shear why = SHEAR_NO_STAMPS; name != NULL && why <= SHEAR_NOT_FINITE;
         why++) {
        if (reasons[why].name != NULL && strcmp(reasons[why].name, name) == 0)
            return why;
    }
    return SHEAR_HAS_SHEAR;
}

const char *sheard_no_shear_words(enum shear_no_shear why) {
    return reason_of(why)->words;
}

bool sheard_one_outweighs(const shear_result *r) {
    enum { FEW = 5 };
    return r->n_used > FEW && r->top_stamp >= 0 && r->top_share * r->top_share * r->n_eff > 0.5;
}

static bool is_spoilt(const shear_result *r) {
    const bool by_sum = r->why == SHEAR_NO_SIGNAL || r->why == SHEAR_SWAPPED ||
                        r->why == SHEAR_TOO_NARROW || r->why == SHEAR_NOT_FINITE;
    return by_sum && sheard_one_outweighs(r);
}

const char *sheard_no_shear_brief(const shear_result *r) {
    return is_spoilt(r) ? "one stamp outweighs all others in the sum of w D"
                        : sheard_no_shear_words(r->why);
}

/* ---- why all stamps are left out ---- */

/* What to do where most stamps have a flag of exposures. */
static const struct {
    unsigned flag;
    const char *advice;
} cures[] = {
    {SHEAR_FLAG_EDGE, "make --stamp smaller: chips must be larger than stamps and their frame of 8 "
                      "px"},
    {SHEAR_FLAG_HOLE, "does the mask mean this (--mask-bad), and is the weight map of this kind "
                      "(--weight-kind)?"},
    {SHEAR_FLAG_SATURATED, "is the image's keyword SATURATE right?"},
    {SHEAR_FLAG_NEIGHBOUR, "is the segmentation that of the image, and are the catalog's ellipses "
                           "in pixels?"},
    {SHEAR_FLAG_NO_NOISE, "make --stamp smaller, or give --noise white or an image of noise"},
    {SHEAR_FLAG_NO_POSITION, "is it the catalog of this exposure, with the right --columns and "
                             "coordinates?"},
};
enum { N_CURES = sizeof cures / sizeof cures[0] };

/* Return the bit of the flag that most stamps have; -1: none has any. */
static int commonest_flag(const shear_result *r) {
    int found = -1;
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        if (r->flagged[bit] > (found >= 0 ? r->flagged[found] : 0))
            found = bit;
    }
    return found;
}

static const char *cure_of(const shear_result *r) {
    const int bit = commonest_flag(r);
    for (int i = 0; i < N_CURES && bit >= 0 && r->why == SHEAR_NO_STAMPS; i++) {
        if (cures[i].flag == 1u << bit)
            return cures[i].advice;
    }
    return reason_of(r->why)->advice;
}

static void say_too_few(const shear_result *r, char *buf, size_t size) {
    const int bit = commonest_flag(r);
    snprintf(buf, size, "%" PRId64 " of %" PRId64 " stamps are usable%s", r->n_used, r->n_stamps,
             r->n_used == 1 ? ", and one stamp has no error" : "");
    if (bit >= 0) {
        text_append(buf, size, " (%" PRId64 " have the flag %s)", r->flagged[bit],
                    shear_flag_name(bit));
    }
}

const char *sheard_no_shear_text(const shear_result *r, char *buf, size_t size) {
    const char *words = reason_of(r->why)->words;
    if (is_spoilt(r)) {
        snprintf(buf, size,
                 "stamp %" PRId64 " outweighs all others together: the sum of w D is %.3g",
                 r->top_stamp, r->sum_d);
    } else if (r->why == SHEAR_NO_STAMPS) {
        say_too_few(r, buf, size);
    } else if (r->why == SHEAR_NO_SYMMETRY && r->n_used < SHEAR_SYMMETRY_FEWEST) {
        snprintf(buf, size, "%" PRId64 " usable stamps are too few for their symmetry", r->n_used);
    } else if (r->why == SHEAR_NO_SIGNAL || r->why == SHEAR_SWAPPED || r->why == SHEAR_TOO_NARROW) {
        snprintf(buf, size, "%s (the sum of w D is %.3g, %.3g sigma)", words, r->sum_d, r->signal);
    } else {
        snprintf(buf, size, "%s", words != NULL ? words : "");
    }
    return buf;
}

const char *sheard_no_shear_advice(const shear_result *r, char *buf, size_t size) {
    const char *advice = cure_of(r);
    if (is_spoilt(r)) {
        return advice_say(buf, size,
                          "look at it (shearctl plot --stamp %" PRId64
                          "), and mask it (column FLAGS) where "
                          "it is no galaxy",
                          r->top_stamp);
    }
    return advice_say(buf, size, "%s", advice != NULL ? advice : "");
}
