/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/field/parts.h"

#include "base/cleanup.h"
#include "base/fingerprint.h"
#include "base/text.h"
#include "fits/header/meds.h"

#include <stdio.h>

/* EXTNAME of the parts in a field file. */
enum { PARTS = SHEAR_PART_IMAGE }; /* the others are those of exposures */
static const char *const extnames[PARTS] = {"GALAXY", "NOISE", "PSF", "CATALOG"};

/* ---- files ---- */

/* Return the number of this file among the open ones, or -1. It does no harm if the path is
 * replaced meanwhile: the file is then the one that was opened. */
static int find_file(const sf_parts *p, const struct stat *st) {
    for (int i = 0; i < p->n_files; i++) {
        if (fingerprint_same_file(&p->stats[i], st))
            return i;
    }
    return -1;
}

/* Open `path`, or the descriptor `fd` (-1: none) called `path` in messages, unless the file is open
 * already. */
static int open_file(sf_parts *p, const char *path, int fd, const sf_file **file,
                     shear_error *err) {
    struct stat *st = &p->stats[p->n_files];
    const bool known = (fd >= 0 ? fstat(fd, st) : stat(path, st)) == 0;
    const int same = known ? find_file(p, st) : -1;
    if (same >= 0) {
        *file = &p->files[same];
        return SHEAR_OK;
    }
    sf_file *f = &p->files[p->n_files];
    p->n_files++; /* so that it is closed, also after an error */
    *file = f;
    TRY(sf_file_open(f, path, fd, err));
    return sf_meds_refuse(f, err);
}

/* ---- HDUs ---- */

static bool holds(const sf_hdu *hdu, int part) {
    if (part == SHEAR_PART_CATALOG)
        return hdu->kind == SF_TABLE && !hdu->zimage;
    return hdu->kind == SF_TABLE ? hdu->zimage : hdu->kind == SF_IMAGE && hdu->naxis > 0;
}

static int find_number(const sf_file *f, int64_t number, const sf_hdu **hdu, shear_error *err) {
    if (number >= f->count) {
        return sf_fail(err, SHEAR_E_FORMAT, (sf_place){f->source.name, NULL},
                       "HDUs are counted from 0, the primary; or give the EXTNAME",
                       "has no HDU number %lld (its last is %d)", (long long)number, f->count - 1);
    }
    *hdu = &f->hdus[number];
    return SHEAR_OK;
}

static int find_default(const sf_file *f, int part, const sf_hdu **hdu, shear_error *err) {
    TRY(sf_file_find(f, extnames[part], false, hdu, err));
    for (int i = 0; *hdu == NULL && i < f->count; i++) {
        if (holds(&f->hdus[i], part))
            *hdu = &f->hdus[i];
    }
    return *hdu != NULL ? SHEAR_OK
                        : sf_fail(err, SHEAR_E_FORMAT, (sf_place){f->source.name, NULL}, NULL,
                                  "has no HDU that holds %s",
                                  part == SHEAR_PART_CATALOG ? "a binary table" : "an image");
}

static int choose(sf_part *part, int i, const shear_input_part *wanted, shear_error *err) {
    if (wanted->extname != NULL) {
        TRY(sf_file_find(part->file, wanted->extname, true, &part->hdu, err));
    } else {
        TRY(wanted->hdu >= 0 ? find_number(part->file, wanted->hdu, &part->hdu, err)
                             : find_default(part->file, i, &part->hdu, err));
    }
    text_set(part->label, sizeof part->label, part->hdu->name);
    if (part->label[0] == '\0')
        snprintf(part->label, sizeof part->label, "%d (from 0)", part->hdu->number);
    return SHEAR_OK;
}

/* Choose the HDU with the part's standard name. A missing HDU is reported later, by
 * sf_part_require. */
static int choose_by_name(sf_part *part, int i, const sf_file *file, shear_error *err) {
    part->file = file;
    text_set(part->label, sizeof part->label, extnames[i]);
    return sf_file_find(file, extnames[i], false, &part->hdu, err);
}

int sf_part_require(const sf_part *part, shear_error *err) {
    const sf_hdu *hdu = part->hdu;
    return hdu != NULL ? SHEAR_OK : sf_file_find(part->file, part->label, true, &hdu, err);
}

/* Refuse one image for two parts: the galaxies minus themselves have no power. */
static int check_distinct(const sf_parts *p, shear_error *err) {
    for (int i = 0; i < PARTS; i++) {
        for (int k = 0; k < i; k++) {
            if (p->of[i].hdu != NULL && p->of[i].hdu == p->of[k].hdu) {
                return sf_fail(
                    err, SHEAR_E_FORMAT, (sf_place){p->of[i].file->source.name, p->of[i].label},
                    "choose the HDU of each: FILE:HDU, by number from 0 or by EXTNAME",
                    "is given both as %s and as %s", shear_part_name(k), shear_part_name(i));
            }
        }
    }
    return SHEAR_OK;
}

static int missing(int part, shear_error *err) {
    return shear_fail(err, SHEAR_E_FORMAT, "give all of galaxy, noise and psf",
                      "there is no file for the %s", shear_part_name(part));
}

static int init_part(sf_parts *p, int i, const shear_input_part *wanted, int fd, shear_error *err) {
    if (wanted->path == NULL) {
        return i == SHEAR_PART_CATALOG
                   ? choose_by_name(&p->of[i], i, p->of[SHEAR_PART_GALAXY].file, err)
                   : missing(i, err);
    }
    TRY(open_file(p, wanted->path, fd, &p->of[i].file, err));
    return choose(&p->of[i], i, wanted, err);
}

int sf_parts_init(sf_parts *p, const shear_input *input, const int *fds, shear_error *err) {
    const sf_file *whole = NULL;
    *p = (sf_parts){0};
    if (input->path != NULL)
        TRY(open_file(p, input->path, fds != NULL ? fds[0] : -1, &whole, err));
    for (int i = 0; i < PARTS; i++) {
        TRY(whole != NULL ? choose_by_name(&p->of[i], i, whole, err)
                          : init_part(p, i, &input->parts[i], fds != NULL ? fds[i] : -1, err));
    }
    return check_distinct(p, err);
}

void sf_parts_deinit(sf_parts *p) {
    for (int i = 0; i < p->n_files; i++)
        sf_file_close(&p->files[i]);
    p->n_files = 0;
}

bool sf_parts_are_whole(const sf_parts *p) {
    bool whole = p->n_files == 1;
    for (int i = 0; i < PARTS && whole; i++) {
        const sf_hdu *hdu = NULL;
        whole = sf_file_find(&p->files[0], extnames[i], false, &hdu, NULL) == SHEAR_OK &&
                hdu == p->of[i].hdu;
    }
    return whole;
}
