/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl mock: write a field file of mock galaxies with a known shear. */
#include "shear_mocks/mock.h"
#include "base/cleanup.h"
#include "cmdline/options.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <assert.h>
#include <inttypes.h>
#include <sys/stat.h>

enum { MAX_THREADS = 1024, MAX_OPTIONS = 64, N_OWN = 3 };

typedef struct mock_options {
    shear_mock_spec spec;
    int64_t threads;
    bool force, quiet;
    const char *path;
} mock_options;

CLEANUP_DEFINE(shear_mock, shear_mock_free)

static enum exit_code set_mock(const option_entry *e, const char *value) {
    shear_error err = {0};
    if (shear_mock_set(e->context, e->name, value, &err) != SHEAR_OK)
        return message_error(&err);
    return EXIT_CODE_DONE;
}

static enum exit_code parse(const command *self, int argc, char **argv, mock_options *o) {
    size_t n = 0;
    const shear_mock_option *table = shear_mock_options(&n);
    option_entry options[MAX_OPTIONS] = {
        {.name = "threads", .integer = &o->threads, .min = 1, .max = MAX_THREADS},
        {.name = "force", .flag = &o->force},
        {.name = "quiet", .flag = &o->quiet}};
    assert(N_OWN + n < MAX_OPTIONS);
    for (size_t i = 0; i < n; i++) {
        options[N_OWN + i] = (option_entry){.name = table[i].name,
                                            .set = set_mock,
                                            .context = &o->spec,
                                            .bare = table[i].metavar == NULL};
    }
    TRY(options_parse(self, argc, argv, options, NULL));
    if (argc - optind != 1)
        return options_fail(self, "expected one output file, got %d", argc - optind);
    o->path = argv[optind];
    return EXIT_CODE_DONE;
}

static const char *rotations(int rotate) {
    switch (rotate) {
    case 2:
        return ", each at 0 and 90 degrees";
    case 4:
        return ", each at 0, 45, 90 and 135 degrees";
    default:
        return "";
    }
}

static void print_report(const mock_options *o, const shear_mock_info *info) {
    const shear_mock_spec *s = &o->spec;
    struct stat st = {0};
    char path[512];
    double megabytes = stat(o->path, &st) == 0 ? (double)st.st_size * 1e-6 : 0.0;
    printf("wrote %s: %" PRId64 " stamp pairs of %dx%d px, %.1f MB\n",
           message_clean(o->path, path, sizeof path), info->n_stamps, s->nx, s->ny, megabytes);
    printf("true shear g1 = %g, g2 = %g; %" PRId64 " %s galaxies%s\n", s->g1, s->g2,
           info->n_galaxies, s->galaxy == SHEAR_MOCK_IRREGULAR ? "irregular" : "regular",
           rotations(s->rotate));
}

static int write_field(const mock_options *o, shear_error *err) {
    CLEANUP(shear_mock_release) shear_mock *m = NULL;
    TRY(shear_mock_new(&m, &o->spec, err));
    progress *bar = o->quiet ? progress_begin_quiet() : progress_begin("mock");
    const shear_mock_write_options how = {.threads = (int)o->threads,
                                          .overwrite = o->force,
                                          .progress = progress_callback,
                                          .context = bar};
    int code = shear_mock_write(m, o->path, &how, err);
    progress_end(bar);
    if (code != SHEAR_OK)
        return code;
    print_report(o, shear_mock_get_info(m));
    return SHEAR_OK;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    mock_options o = {.quiet = false};
    shear_error err = {0};
    shear_mock_spec_init(&o.spec);
    const enum exit_code parsed = parse(self, argc, argv, &o);
    if (parsed != EXIT_CODE_DONE)
        return parsed;
    const int code = write_field(&o, &err);
    if (code != SHEAR_OK) {
        message_error(&err);
        return code == SHEAR_E_SETTING ? EXIT_CODE_USAGE : EXIT_CODE_OTHER;
    }
    return EXIT_CODE_DONE;
}

/* A test compares this text with the table: every option must be listed with its default. */
const command cmd_mock = {
    .name = "mock",
    .summary = "make a field file of mock galaxies with a known shear",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl mock [OPTION...] OUT.fits\n"
    "\n"
    "Draw mock galaxies as in section 4.1 of Zhang (2010): galaxies and astronomical noise are\n"
    "point sources, lensed, and convolved with a PSF. Lengths are in pixels. Without options:\n"
    "2000 regular galaxy stamps without noise, in pairs turned by 90 degrees.\n"
    "\n"
    "field:\n"
    "  --stamps N              stamp pairs (default 2000)\n"
    "  --size NX[xNY]          pixels of a stamp (default 64x64)\n"
    "  --shear G1,G2           the true shear (default 0.02,-0.03)\n"
    "  --seed S                the same seed gives the same galaxies and noise at any shear\n"
    "                          (default 1)\n"
    "  --rotate 1|2|4          each galaxy once, at 0 and 90, or at 0, 45, 90 and 135 degrees,\n"
    "                          in neighbouring stamps (default 2)\n"
    "  --no-shift              no random sub-pixel position of the galaxies (default no)\n"
    "  --offset DX,DY          move every galaxy by this much (default 0,0)\n"
    "  --share-shift           rotated copies have the same sub-pixel position (default no)\n"
    "  --share-noise           rotated copies have the same noise (default no)\n"
    "  --turn-stamps           copies at 90 degrees are whole stamps turned, position and noise too\n"
    "                          (default no)\n"
    "galaxies:\n"
    "  --galaxy regular|irregular  disk and bulge, or random walk (default regular)\n"
    "  --r-gal PX              radius R_G at which a galaxy is cut (default 6)\n"
    "  --points N              points of a regular galaxy (default 600)\n"
    "  --bulge-fraction X      f_b/d, brightness of the bulge over the disk's at the centre\n"
    "                          (default 1/3)\n"
    "  --disk-scale X          r_disk / R_G (default 1)\n"
    "  --bulge-ratio X         r_disk / r_bulge (default 3)\n"
    "  --inclination MIN,MAX   range of the inclinations, degrees (default 0,30)\n"
    "  --steps N               steps of an irregular galaxy (default 1000)\n"
    "  --step-size PX          length of a step (default 0.375)\n"
    "PSF:\n"
    "  --psf a|b               W_A, or W_B with diffraction spikes (default a)\n"
    "  --r-psf PX              scale radius R_PSF (default 1.5)\n"
    "  --psf-angle DEG         turns the PSF from x towards y (default 30)\n"
    "  --oversamp K            samples of the PSF image per pixel (default 1)\n"
    "  --psf-size N            samples per side of the PSF image; auto: all that exceeds 1e-20 of\n"
    "                          the peak (default auto)\n"
    "  --psf-per-stamp         every stamp has its own PSF, at a random angle (default no)\n"
    "  --psf-ids K             K PSFs at random angles, told apart by PSF_ID (default 0)\n"
    "noise (any combination; the noise stamps have their own, of the same kind):\n"
    "  --noise-stamps N        noise stamps per galaxy (default 1)\n"
    "  --noise-ratio X         astronomical: I_N/I_G, the mean flux density of the noise over\n"
    "                          the galaxy's (default 0)\n"
    "  --noise-density N       its points per square pixel; auto: 1/R_PSF^2 (default auto)\n"
    "  --white SIGMA           white Gaussian noise per pixel, in units of the peak of one\n"
    "                          point, or in photons (default 0)\n"
    "  --photons N             photon counting: background photons per pixel (default 0)\n"
    "  --photon-snr X          mean surface brightness, galaxy over background (default 1)\n"
    "  --subtract-background   take the mean background off the photon counts (default no)\n"
    "file:\n"
    "  --field NAME            the field's name (default: the file's)\n"
    "  --layout cube|mosaic    of the stamps (default cube)\n"
    "  --bitpix -32|-64        float or double pixels (default -32)\n"
    "  --no-r-gal              leave R_GAL out of the catalog (default no)\n"
    "  --force                 replace a file that exists\n"
    "  --threads N             worker threads (default: all cores); the file does not depend on\n"
    "                          it\n"
    "  --quiet                 no progress bar\n"
    "\n"
    "exit status: 0 done, 2 usage, 1 anything else.\n",
    /* clang-format on */
};
