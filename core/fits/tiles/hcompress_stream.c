/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sf_hcompress_sound: follow an H-compress stream bit by bit without rebuilding the image.
 *
 * After its header the stream has four quadrants of coefficients (of the sums and differences in x
 * and y). Each has a number of bit planes, and each plane is either plain nybbles or a quadtree
 * whose nodes are Huffman-coded nybbles: a set bit of a node means that its quarter is not empty. A
 * nybble of zero follows, and then a sign bit for every coefficient that is not zero, so these must
 * be tracked. */
#include "fits/io/bits.h"
#include "fits/tiles/tile_stream.h"

#include <string.h>

typedef struct walk {
    sf_bits bits;
    int64_t stride;          /* coefficients per row */
    unsigned char *nonzero;  /* [nx][stride] */
    unsigned char *nodes[2]; /* one level of the quadtree, and the next */
} walk;

static int64_t half(int64_t n) {
    return (n + 1) / 2;
}

/* Read a node's four bits. Nodes with one bit set have the shortest codes; those of one length are
 * consecutive numbers (a canonical Huffman code). */
static bool read_node(sf_bits *b, unsigned char *node) {
    enum { SHORTEST = 3, LENGTHS = 4 };
    static const int n_of_length[LENGTHS] = {4, 5, 5, 2};
    static const unsigned char nodes[] = {1, 2, 4, 8, 3, 5, 10, 12, 15, 6, 7, 9, 11, 13, 0, 14};
    const unsigned char *first = nodes; /* of this length */
    int code = 0;                       /* minus the code of *first */
    for (int i = 0; i < LENGTHS; first += n_of_length[i++]) {
        int bits = 0;
        if (!sf_bits_read(b, i == 0 ? SHORTEST : 1, &bits))
            return false;
        code = 2 * code + bits;
        if (code < n_of_length[i]) {
            *node = first[code];
            return true;
        }
        code -= n_of_length[i];
    }
    return false;
}

/* Return the bit of (x, y) in the node above it. */
static int bit_of(const unsigned char *nodes, int64_t row, int64_t x, int64_t y) {
    return nodes[x / 2 * row + y / 2] >> (3 - 2 * (x % 2) - y % 2) & 1;
}

/* Expand the nodes of one level to the nx x ny nodes of the next: for each bit that is set, the
 * stream has a node. They are stored from the last to the first. */
static bool expand(walk *w, int64_t nx, int64_t ny) {
    unsigned char *next = w->nodes[1];
    for (int64_t i = nx * ny - 1; i >= 0; i--) {
        next[i] = 0;
        if (bit_of(w->nodes[0], half(ny), i / ny, i % ny) != 0 && !read_node(&w->bits, &next[i]))
            return false;
    }
    w->nodes[1] = w->nodes[0];
    w->nodes[0] = next;
    return true;
}

/* Read one plane's quadtree down to its lowest nodes, one for 2 x 2 coefficients. */
static bool read_tree(walk *w, int64_t nx, int64_t ny, int levels) {
    int64_t rest_x = nx;
    int64_t rest_y = ny;
    int64_t size = INT64_C(1) << levels;
    int64_t level_x = 1;
    int64_t level_y = 1;
    if (!read_node(&w->bits, &w->nodes[0][0]))
        return false;
    for (int k = 1; k < levels; k++) {
        size /= 2;
        level_x = 2 * level_x - (rest_x <= size ? 1 : 0);
        level_y = 2 * level_y - (rest_y <= size ? 1 : 0);
        rest_x -= rest_x <= size ? 0 : size;
        rest_y -= rest_y <= size ? 0 : size;
        if (!expand(w, level_x, level_y))
            return false;
    }
    return true;
}

static bool read_plain(walk *w, int64_t nodes) {
    for (int64_t i = 0; i < nodes; i++) {
        int node = 0;
        if (!sf_bits_read(&w->bits, 4, &node))
            return false;
        w->nodes[0][i] = (unsigned char)node;
    }
    return true;
}

static bool read_plane(walk *w, unsigned char *corner, int64_t nx, int64_t ny, int levels) {
    int form = 0;
    if (!sf_bits_read(&w->bits, 4, &form))
        return false;
    const bool taken = form == 0    ? read_plain(w, half(nx) * half(ny))
                       : form == 15 ? read_tree(w, nx, ny, levels)
                                    : false;
    for (int64_t i = 0; taken && i < nx * ny; i++) {
        if (bit_of(w->nodes[0], half(ny), i / ny, i % ny) != 0)
            corner[i / ny * w->stride + i % ny] = 1;
    }
    return taken;
}

static bool read_quadrant(walk *w, int64_t x, int64_t y, int64_t nx, int64_t ny, int planes) {
    int levels = 0;
    while ((INT64_C(1) << levels) < nx || (INT64_C(1) << levels) < ny)
        levels++;
    for (int plane = 0; plane < planes; plane++) {
        if (!read_plane(w, w->nonzero + x * w->stride + y, nx, ny, levels))
            return false;
    }
    return true;
}

static bool read_signs(walk *w, int64_t pixels) {
    int64_t signs = 0;
    for (int64_t i = 0; i < pixels; i++)
        signs += w->nonzero[i];
    w->bits.position = (w->bits.position + 7) / 8 * 8;
    return sf_bits_skip(&w->bits, signs);
}

bool sf_hcompress_sound(const unsigned char *bytes, int64_t count, const int64_t sides[3],
                        bool wide, unsigned char *work) {
    enum { NX = 2, NY = 6, PLANES = 22, HEADER = 25, MIN_SIDE = 2 };
    static const unsigned char magic[2] = {0xdd, 0x99};
    if (count < HEADER || memcmp(bytes, magic, sizeof magic) != 0)
        return false;
    const int64_t nx = (int32_t)sf_bits_big_endian(bytes + NX, 4);
    const int64_t ny = (int32_t)sf_bits_big_endian(bytes + NY, 4);
    const int64_t pixels = nx * ny;
    const unsigned char *planes = bytes + PLANES;
    const int most = wide ? 62 : 31;
    if (nx < MIN_SIDE || ny < MIN_SIDE || nx != sides[1] || ny != sides[0] || sides[2] != 1 ||
        planes[0] > most || planes[1] > most || planes[2] > most) {
        return false;
    }
    memset(work, 0, (size_t)pixels);
    walk w = {.bits = {.bytes = bytes + HEADER, .count = 8 * (count - HEADER)},
              .stride = ny,
              .nonzero = work,
              .nodes = {work + pixels, work + 2 * pixels}};
    int end = 1;
    return read_quadrant(&w, 0, 0, half(nx), half(ny), planes[0]) &&
           read_quadrant(&w, 0, half(ny), half(nx), ny / 2, planes[1]) &&
           read_quadrant(&w, half(nx), 0, nx / 2, half(ny), planes[1]) &&
           read_quadrant(&w, half(nx), half(ny), nx / 2, ny / 2, planes[2]) &&
           sf_bits_read(&w.bits, 4, &end) && end == 0 && read_signs(&w, pixels);
}
