# SPDX-License-Identifier: GPL-3.0-or-later
"""FITS files made by hand, byte by byte: field files of Gaussians, whose shear is known in closed
form, and whatever a bad file needs. Independent of the library's writer and of any FITS package."""
import array
import math
import random
import struct
import sys

BLOCK = 2880
TYPECODES = {-64: "d", -32: "f", 8: "B", 16: "h", 32: "i"}


def card(key, value=None):
    """One 80-character card. Strings are quoted; value None gives the bare key."""
    if value is None:
        text = key
    elif isinstance(value, bool):
        text = f"{key:<8}= {'T' if value else 'F':>20}"
    elif isinstance(value, str):
        quoted = "'" + value.replace("'", "''").ljust(8) + "'"
        text = f"{key:<8}= {quoted:<20}"
    elif isinstance(value, float):
        text = f"{key:<8}= {value!r:>20}".replace("e", "E")
    else:
        text = f"{key:<8}= {value:>20}"
    assert len(text) <= 80, text
    return text.ljust(80).encode("ascii")


def pad(data, fill=b"\0"):
    return data + fill * (-len(data) % BLOCK)


def header(cards):
    """Cards, as (key, value) pairs, to a padded header."""
    return pad(b"".join(card(*c) for c in cards) + card("END"), b" ")


def primary(**keys):
    cards = [("SIMPLE", True), ("BITPIX", 8), ("NAXIS", 0), ("EXTEND", True)]
    return header(cards + [(k, v) for k, v in keys.items() if v is not None])


def big_endian(values, bitpix):
    data = array.array(TYPECODES[bitpix], values)
    if sys.byteorder == "little":
        data.byteswap()
    return data.tobytes()


def image(name, axes, values, bitpix=-32, extra=()):
    """An IMAGE extension; axes in FITS order (NAXIS1 first)."""
    cards = [("XTENSION", "IMAGE"), ("BITPIX", bitpix), ("NAXIS", len(axes))]
    cards += [(f"NAXIS{i + 1}", n) for i, n in enumerate(axes)]
    cards += [("PCOUNT", 0), ("GCOUNT", 1), ("EXTNAME", name), *extra]
    return header(cards) + pad(big_endian(values, bitpix))


def table(name, columns):
    """A BINTABLE; columns are (name, "D" or "K" or "J", values)."""
    codes = {"D": ("d", 8), "K": ("q", 8), "J": ("i", 4)}
    width = sum(codes[kind][1] for _, kind, _ in columns)
    rows = len(columns[0][2])
    cards = [("XTENSION", "BINTABLE"), ("BITPIX", 8), ("NAXIS", 2), ("NAXIS1", width),
             ("NAXIS2", rows),
             ("PCOUNT", 0), ("GCOUNT", 1), ("TFIELDS", len(columns)), ("EXTNAME", name)]
    for i, (key, kind, _) in enumerate(columns):
        cards += [(f"TTYPE{i + 1}", key), (f"TFORM{i + 1}", kind)]
    row = ">" + "".join(codes[kind][0] for _, kind, _ in columns)
    data = b"".join(struct.pack(row, *values) for values in zip(*(c[2] for c in columns)))
    return header(cards) + pad(data)


def gaussian(nx, ny, flux, cov, dx=0.0, dy=0.0):
    """A Gaussian of covariance (xx, yy, xy), sampled at the pixels' centres: ny*nx values."""
    xx, yy, xy = cov
    det = xx * yy - xy * xy
    peak = flux / (2 * math.pi * math.sqrt(det))
    exp = math.exp
    out = []
    for j in range(ny):
        y = j - (ny - 1) / 2 - dy
        for i in range(nx):
            x = i - (nx - 1) / 2 - dx
            out.append(peak * exp(-0.5 * (yy * x * x - 2 * xy * x * y + xx * y * y) / det))
    return out


def galaxy_covariance(size, g1, g2):
    """A round galaxy of scale `size`, sheared: A A^T size^2 with A = ((1+g1, g2), (g2, 1-g1))."""
    s = size * size
    return (s * ((1 + g1) ** 2 + g2 ** 2), s * ((1 - g1) ** 2 + g2 ** 2), s * 2 * g2)


def expected_shear(galaxy_cov, beta):
    """What the estimator (docs/method.md, step 6) returns for Gaussians, in closed form. After the
    transform to the target PSF the image has covariance C = galaxy_cov + beta^2; its power,
    exp(-k C k), is a Gaussian with S = C^-1 / 2, so that M20 = Sxx, M02 = Syy, M11 = Sxy and
    M4 = 3 Sxx^2 + 3 Syy^2 + 2 Sxx Syy + 4 Sxy^2."""
    xx, yy, xy = galaxy_cov[0] + beta ** 2, galaxy_cov[1] + beta ** 2, galaxy_cov[2]
    det = 2 * (xx * yy - xy * xy)
    sxx, syy, sxy = yy / det, xx / det, -xy / det
    m4 = 3 * sxx ** 2 + 3 * syy ** 2 + 2 * sxx * syy + 4 * sxy ** 2
    d = sxx + syy - beta ** 2 / 2 * m4
    return -(sxx - syy) / 2 / d, -sxy / d


class Field:
    """A field of Gaussian galaxies that differ in flux and position, but not in shape: with a
    Gaussian PSF each stamp alone has the closed-form shear. Change the attributes, then write()."""

    def __init__(self, n=20, nx=48, ny=48, g1=0.03, g2=-0.02, size=3.0, r_psf=1.5, sigma=0.0,
                 seed=1, name="gauss", truth=True, psf_oversample=1):
        rng = random.Random(seed)
        self.n, self.nx, self.ny, self.name = n, nx, ny, name
        self.r_psf, self.oversample = r_psf, psf_oversample
        self.keys = {"SIM_G1": float(g1), "SIM_G2": float(g2)} if truth else {}
        self.cov = galaxy_covariance(size, g1, g2)
        observed = (self.cov[0] + r_psf ** 2, self.cov[1] + r_psf ** 2, self.cov[2])
        self.galaxy = [gaussian(nx, ny, 500 + 500 * rng.random(), observed, rng.random() - 0.5,
                                rng.random() - 0.5)
                       for _ in range(n)]
        self.noise = [[0.0] * (nx * ny) for _ in range(n)]
        if sigma > 0:
            for stamps in (self.galaxy, self.noise):
                for stamp in stamps:
                    stamp[:] = [p + rng.gauss(0, sigma) for p in stamp]
        self.psf_nx = self.psf_ny = nx if psf_oversample == 1 else 32 * psf_oversample // 2 * 2 + 1
        scale = r_psf * psf_oversample
        self.psf = gaussian(self.psf_nx, self.psf_ny, 1.0, (scale ** 2, scale ** 2, 0.0))
        self.psf_cube = None    # several PSFs instead of the one
        self.columns = []
        self.bitpix = -32
        self.blank = None       # with an integer bitpix: BLANK; pixels are stored in units of 1/100
        self.skip = ()          # EXTNAMEs to leave out
        self.noise_axes = None  # another shape than the galaxies'

    def expected(self, beta_ratio=1.5):
        return expected_shear(self.cov, beta_ratio * self.r_psf)

    def scaling(self):
        return [] if self.bitpix < 0 else [("BSCALE", 0.01), ("BZERO", 0.0), ("BLANK", self.blank)]

    def stored(self, pixels):
        if self.bitpix < 0:
            return pixels
        return [self.blank if math.isnan(p) else round(100 * p) for p in pixels]

    def content(self):
        flat = lambda stamps: [p for stamp in stamps for p in stamp]
        axes = (self.nx, self.ny, self.n)
        noise_axes = self.noise_axes or axes
        noise = flat(self.noise)[:math.prod(noise_axes)]
        noise += [0.0] * (math.prod(noise_axes) - len(noise))
        hdus = {name: image(name, size, self.stored(pixels), self.bitpix, self.scaling())
                for name, size, pixels in (("GALAXY", axes, flat(self.galaxy)),
                                           ("NOISE", noise_axes, noise))}
        extra = [("OVERSAMP", self.oversample)] if self.oversample > 1 else []
        psf_axes = (self.psf_nx, self.psf_ny) + ((len(self.psf_cube),) if self.psf_cube else ())
        hdus["PSF"] = image("PSF", psf_axes, flat(self.psf_cube or [self.psf]), -64, extra)
        if self.columns:
            hdus["CATALOG"] = table("CATALOG", self.columns)
        return primary(FIELD=self.name, **self.keys) + b"".join(
            data for name, data in hdus.items() if name not in self.skip)

    def write(self, path):
        with open(path, "wb") as f:
            f.write(self.content())
        return str(path)


def rotate(stamp, n):
    """A square stamp turned by 90 degrees: f'(x, y) = f(y, -x)."""
    return [stamp[(n - 1 - x) * n + y] for y in range(n) for x in range(n)]


def hdus(content):
    """A file taken apart: (EXTNAME or "", bytes) of each HDU."""
    found, at = [], 0
    while at < len(content):
        end, keys = at, {}
        while content[end:end + 80] != card("END"):
            text = content[end:end + 80].decode("ascii")
            if text[8:10] == "= ":
                keys[text[:8].strip()] = text[10:].split(" /")[0].strip().strip("'").strip()
            end += 80
        data = end + 80 + -(end + 80 - at) % BLOCK
        size = abs(int(keys["BITPIX"])) // 8 if int(keys["NAXIS"]) else 0
        for i in range(int(keys["NAXIS"])):
            size *= int(keys[f"NAXIS{i + 1}"])
        size += int(keys.get("PCOUNT", 0))
        after = data + size + -size % BLOCK
        found.append((keys.get("EXTNAME", ""), content[at:after]))
        at = after
    return found
