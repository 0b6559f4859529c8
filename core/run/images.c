/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/images.h"

#include <stddef.h>

/* Convert a row of n pixels, `step` bytes apart. */
typedef void convert_row(const char *in, ptrdiff_t step, int n, double *out);

#define CONVERT_ROW(name, pixel)                                                                   \
    static void name(const char *in, ptrdiff_t step, int n, double *out) {                         \
        for (int x = 0; x < n; x++) {                                                              \
            out[x] = (double)*(const pixel *)(const void *)(in + x * step);                        \
        }                                                                                          \
    }
CONVERT_ROW(from_double, double)
CONVERT_ROW(from_float, float)
CONVERT_ROW(from_int32, int32_t)
CONVERT_ROW(from_int16, int16_t)
CONVERT_ROW(from_uint16, uint16_t)
CONVERT_ROW(from_uint8, uint8_t)

static const struct {
    ptrdiff_t size;
    convert_row *convert;
} types[] = {
    [SHEAR_PIXEL_DOUBLE] = {sizeof(double), from_double},
    [SHEAR_PIXEL_FLOAT] = {sizeof(float), from_float},
    [SHEAR_PIXEL_INT32] = {sizeof(int32_t), from_int32},
    [SHEAR_PIXEL_INT16] = {sizeof(int16_t), from_int16},
    [SHEAR_PIXEL_UINT16] = {sizeof(uint16_t), from_uint16},
    [SHEAR_PIXEL_UINT8] = {sizeof(uint8_t), from_uint8},
};
enum { N_TYPES = sizeof types / sizeof types[0] };

static bool has_strides(const shear_images *in) {
    return in->image != 0 || in->plane != 0 || in->row != 0 || in->column != 0;
}

/* Return the same images with the strides of an array without gaps. */
static shear_images packed(const shear_images *in, int planes, int nx, int ny) {
    shear_images m = *in;
    m.column = types[in->type].size;
    m.row = nx * m.column;
    m.plane = ny * m.row;
    m.image = planes * m.plane;
    return m;
}

int images_init(images *m, const shear_images *in, int planes, int nx, int ny, const char *name,
                shear_error *err) {
    if (in->pixels == NULL)
        return shear_fail(err, SHEAR_E_FORMAT, "give the array", "there are no %s pixels", name);
    if ((unsigned)in->type >= N_TYPES) {
        return shear_fail(err, SHEAR_E_FORMAT, "use one of enum shear_pixel_type",
                          "the %s pixels are of type %d, which does not exist", name,
                          (int)in->type);
    }
    *m = (images){.in = has_strides(in) ? *in : packed(in, planes, nx, ny),
                  .planes = planes,
                  .nx = nx,
                  .ny = ny};
    return SHEAR_OK;
}

bool images_are_plain(const images *m) {
    const shear_images p = packed(&m->in, m->planes, m->nx, m->ny);
    return m->in.type == SHEAR_PIXEL_DOUBLE && m->in.column == p.column && m->in.row == p.row &&
           (m->planes == 1 || m->in.plane == p.plane) && m->in.image == p.image;
}

static const char *at(const images *m, int64_t i) {
    return (const char *)m->in.pixels + i * m->in.image;
}

void images_copy(const images *m, int64_t i, double *out) {
    convert_row *convert = types[m->in.type].convert;
    for (int k = 0; k < m->planes; k++) {
        for (int y = 0; y < m->ny; y++, out += m->nx)
            convert(at(m, i) + k * m->in.plane + y * m->in.row, m->in.column, m->nx, out);
    }
}

const double *images_get(const images *m, int64_t first, int count, double *scratch) {
    if (images_are_plain(m))
        return (const double *)(const void *)at(m, first);
    const size_t pixels = (size_t)m->planes * (size_t)m->ny * (size_t)m->nx;
    for (int i = 0; i < count; i++)
        images_copy(m, first + i, scratch + (size_t)i * pixels);
    return scratch;
}
