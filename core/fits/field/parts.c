/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/field/parts.h"

#include "base/cleanup.h"
#include "base/text.h"

#include <stdio.h>

/* EXTNAME of the parts in a field file. */
static const char *const extnames[SHEAR_N_PARTS] = {"GALAXY", "NOISE", "PSF", "CATALOG"};

/* ---- files ---- */

/* Return the number of this file among the open ones, or -1. It does no harm if the path is
 * replaced meanwhile: the file is then the one that was opened. */
static int find_file(const sf_parts *p, const struct stat *st) {
    for (int i = 0; i < p->n_files; i++) {
        if (p->stats[i].st_dev == st->st_dev && p->stats[i].st_ino == st->st_ino)
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
    return fd >= 0 ? sf_file_open_fd(f, fd, path, err) : sf_file_open(f, path, err);
}

/* ---- HDUs ---- */

static bool holds(const sf_hdu *hdu, int part) {
    if (part == SHEAR_PART_CATALOG)
        return hdu->kind == SF_TABLE && !hdu->zimage;
    return hdu->kind == SF_TABLE ? hdu->zimage : hdu->kind == SF_IMAGE && hdu->naxis > 0;
}

static int find_number(const sf_hdu_index *s, int64_t number, const sf_hdu **hdu,
                       shear_error *err) {
    if (number >= s->count) {
        return sf_fail(err, SHEAR_E_FORMAT, (sf_place){s->file, NULL},
                       "HDUs are counted from 0, the primary; or give the EXTNAME",
                       "has no HDU number %lld (its last is %d)", (long long)number, s->count - 1);
    }
    *hdu = &s->hdus[number];
    return SHEAR_OK;
}

static int find_default(const sf_hdu_index *s, int part, const sf_hdu **hdu, shear_error *err) {
    TRY(sf_hdu_index_find(s, extnames[part], false, hdu, err));
    for (int i = 0; *hdu == NULL && i < s->count; i++) {
        if (holds(&s->hdus[i], part))
            *hdu = &s->hdus[i];
    }
    return *hdu != NULL ? SHEAR_OK
                        : sf_fail(err, SHEAR_E_FORMAT, (sf_place){s->file, NULL}, NULL,
                                  "has no HDU that holds %s",
                                  part == SHEAR_PART_CATALOG ? "a binary table" : "an image");
}

static void label(sf_part *part) {
    const sf_hdu *hdu = part->hdu;
    if (hdu->name[0] != '\0') {
        text_set(part->label, sizeof part->label, hdu->name);
    } else {
        snprintf(part->label, sizeof part->label, "%d (from 0)", hdu->number);
    }
}

static int find_wanted(const sf_hdu_index *s, int i, const shear_input_part *wanted,
                       const sf_hdu **hdu, shear_error *err) {
    if (wanted->extname != NULL)
        return sf_hdu_index_find(s, wanted->extname, true, hdu, err);
    return wanted->hdu >= 0 ? find_number(s, wanted->hdu, hdu, err) : find_default(s, i, hdu, err);
}

static int choose(sf_parts *p, int i, const shear_input_part *wanted, shear_error *err) {
    TRY(find_wanted(&p->of[i].file->index, i, wanted, &p->of[i].hdu, err));
    label(&p->of[i]);
    return SHEAR_OK;
}

/* Choose the HDU with the part's standard name. A missing HDU is reported later, by
 * sf_part_require. */
static int choose_by_name(sf_parts *p, int i, const sf_file *file, shear_error *err) {
    p->of[i].file = file;
    text_set(p->of[i].label, sizeof p->of[i].label, extnames[i]);
    return sf_hdu_index_find(&file->index, extnames[i], false, &p->of[i].hdu, err);
}

int sf_part_require(const sf_part *part, shear_error *err) {
    const sf_hdu *hdu = part->hdu;
    return hdu != NULL ? SHEAR_OK
                       : sf_hdu_index_find(&part->file->index, part->label, true, &hdu, err);
}

/* Refuse one image for two parts: the galaxies minus themselves have no power. */
static int check_distinct(const sf_parts *p, shear_error *err) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
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

static int init_whole(sf_parts *p, const char *path, int fd, shear_error *err) {
    const sf_file *file = NULL;
    int rc = open_file(p, path, fd, &file, err);
    for (int i = 0; i < SHEAR_N_PARTS && rc == SHEAR_OK; i++)
        rc = choose_by_name(p, i, file, err);
    return rc;
}

static int missing(int part, shear_error *err) {
    return shear_fail(err, SHEAR_E_FORMAT, "give all of galaxy, noise and psf",
                      "there is no file for the %s", shear_part_name(part));
}

static int init_part(sf_parts *p, int i, const shear_input_part *wanted, int fd, shear_error *err) {
    if (wanted->path == NULL) {
        return i == SHEAR_PART_CATALOG ? choose_by_name(p, i, p->of[SHEAR_PART_GALAXY].file, err)
                                       : missing(i, err);
    }
    const int rc = open_file(p, wanted->path, fd, &p->of[i].file, err);
    return rc == SHEAR_OK ? choose(p, i, wanted, err) : rc;
}

int sf_parts_init(sf_parts *p, const shear_input *input, const int *fds, shear_error *err) {
    *p = (sf_parts){0};
    if (input->path != NULL)
        return init_whole(p, input->path, fds != NULL ? fds[0] : -1, err);
    int rc = SHEAR_OK;
    for (int i = 0; i < SHEAR_N_PARTS && rc == SHEAR_OK; i++)
        rc = init_part(p, i, &input->parts[i], fds != NULL ? fds[i] : -1, err);
    return rc == SHEAR_OK ? check_distinct(p, err) : rc;
}

void sf_parts_deinit(sf_parts *p) {
    for (int i = 0; i < p->n_files; i++)
        sf_file_close(&p->files[i]);
    p->n_files = 0;
}

bool sf_parts_are_whole(const sf_parts *p) {
    bool whole = p->n_files == 1;
    for (int i = 0; i < SHEAR_N_PARTS && whole; i++) {
        const sf_hdu *hdu = NULL;
        whole = sf_hdu_index_find(&p->files[0].index, extnames[i], false, &hdu, NULL) == SHEAR_OK &&
                hdu == p->of[i].hdu;
    }
    return whole;
}
