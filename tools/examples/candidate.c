/* Volume rendering in C, f32, handed to the judge without any library:
 *
 *     cc -O2 -o candidate candidate.c -lm && ./candidate CASES ANSWERS
 *
 * Everything but `volume_render` and `main` reads and writes npz files and can be copied as it is. An npz is a zip archive of npy files;
 * the cases are stored, not compressed, and little-endian, as answers must be. A zip is read from its end: the last 22 bytes say where the
 * list of its entries is, and each entry says where its bytes are. */
#include <glob.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct {
    char name[64];
    int dims;
    long shape[4], count;
    float *data;
} Array;

static void fail(const char *file, const char *what) {
    fprintf(stderr, "%s: %s\n", file, what);
    exit(2);
}

static uint32_t u16(const unsigned char *p) { return p[0] | p[1] << 8; }
static uint32_t u32(const unsigned char *p) { return u16(p) | u16(p + 2) << 16; }

static long product(const Array *a) {
    long n = 1;
    for (int d = 0; d < a->dims; d++) n *= a->shape[d];
    return n;
}

/* One npy: "\x93NUMPY", version, length of the header, the header as a Python dict, the numbers. */
static Array read_npy(const char *file, const char *name, const unsigned char *p, size_t size) {
    Array a = {0};
    size_t start = size > 12 && p[6] == 1 ? 10 : 12;
    if (size < 12 || memcmp(p, "\x93NUMPY", 6)) fail(file, "an entry is no npy");
    size_t header = start == 10 ? u16(p + 8) : u32(p + 8);
    if (header > 4096 || start + header > size) fail(file, "an npy header is cut off");
    char text[4097];
    memcpy(text, p + start, header);
    text[header] = 0;
    if (strlen(name) < sizeof a.name) strcpy(a.name, name);
    if (!strstr(text, "'<f4'")) return a; /* another type: counts, hyper-parameters in f64 */
    if (strstr(text, "'fortran_order': True")) fail(file, "columns first; expected rows first");
    const char *s = strchr(text, '(');
    while (s && *s && *s != ')' && a.dims < 4) {
        char *end;
        long n = strtol(++s, &end, 10);
        if (end > s) a.shape[a.dims++] = n;
        s = end + strspn(end, " ");
    }
    a.count = product(&a);
    if (size - start - header < 4 * (size_t)a.count) fail(file, "an npy is cut off");
    a.data = malloc(4 * (size_t)a.count + 4);
    memcpy(a.data, p + start + header, 4 * (size_t)a.count);
    return a;
}

/* All f32 arrays of an npz; returns how many. */
static int read_npz(const char *file, Array *arrays, int most) {
    FILE *f = fopen(file, "rb");
    if (!f) fail(file, "can't be opened");
    fseek(f, 0, SEEK_END);
    long size = ftell(f);
    rewind(f);
    unsigned char *zip = malloc(size > 0 ? size : 1);
    if (size < 22 || fread(zip, 1, size, f) != (size_t)size) fail(file, "too short for a zip");
    fclose(f);
    const unsigned char *end = zip + size - 22;
    if (u32(end) != 0x06054b50) fail(file, "no zip, or one with a comment");
    uint32_t entries = u16(end + 10), at = u32(end + 16);
    int found = 0;
    for (uint32_t n = 0; n < entries && found < most; n++) {
        const unsigned char *e = zip + at;
        if (at + 46 > (uint32_t)size || u32(e) != 0x02014b50) fail(file, "the list of entries is damaged");
        uint32_t bytes = u32(e + 24), length = u16(e + 28), local = u32(e + 42);
        if (u16(e + 10) != 0) fail(file, "compressed; expected stored entries");
        char name[64] = {0};
        memcpy(name, e + 46, length < 63 ? length : 63);
        char *dot = strstr(name, ".npy");
        if (dot) *dot = 0;
        if (local + 30 > (uint32_t)size) fail(file, "the list of entries is damaged");
        uint32_t data = local + 30 + u16(zip + local + 26) + u16(zip + local + 28);
        if (data > (uint32_t)size || bytes > (uint32_t)size - data) fail(file, "an entry is cut off");
        Array a = read_npy(file, name, zip + data, bytes);
        if (a.data) arrays[found++] = a;
        at += 46 + length + u16(e + 30) + u16(e + 32);
    }
    free(zip);
    return found;
}

static uint32_t crc32(const unsigned char *p, size_t n) {
    uint32_t crc = ~0u;
    while (n--) {
        crc ^= *p++;
        for (int k = 0; k < 8; k++) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    return ~crc;
}

static void put(FILE *f, uint32_t value, int bytes) {
    for (; bytes--; value >>= 8) fputc(value & 255, f);
}

/* The fields that an entry's own header and its line in the list have in common. */
static void describe(FILE *f, uint32_t crc, uint32_t size, uint32_t length) {
    put(f, 20, 2), put(f, 0, 2), put(f, 0, 2), put(f, 0, 2), put(f, 0x21, 2); /* version, flags, stored, time, 1980-01-01 */
    put(f, crc, 4), put(f, size, 4), put(f, size, 4), put(f, length, 2), put(f, 0, 2);
}

static void write_npz(const char *file, const Array *arrays, int count) {
    uint32_t crc[16], size[16], start[16];
    char name[80];
    FILE *f = fopen(file, "wb");
    if (!f) fail(file, "can't be written");
    for (int n = 0; n < count; n++) {
        const Array *a = &arrays[n];
        char shape[100] = "", header[256];
        for (int d = 0; d < a->dims; d++) snprintf(shape + strlen(shape), 20, "%ld,", a->shape[d]);
        int used = snprintf(header, sizeof header, "{'descr': '<f4', 'fortran_order': False, 'shape': (%s), }", shape);
        int padded = (10 + used + 1 + 63) / 64 * 64 - 10; /* the numbers start at a multiple of 64 */
        size[n] = 10 + padded + 4 * (uint32_t)a->count;
        unsigned char *npy = malloc(size[n]);
        memcpy(npy, "\x93NUMPY\1", 8);
        npy[8] = padded & 255, npy[9] = padded >> 8;
        memset(npy + 10, ' ', padded);
        memcpy(npy + 10, header, used);
        npy[10 + padded - 1] = '\n';
        if (a->count) memcpy(npy + 10 + padded, a->data, 4 * (size_t)a->count);
        crc[n] = crc32(npy, size[n]);
        start[n] = ftell(f);
        uint32_t length = snprintf(name, sizeof name, "%s.npy", a->name);
        put(f, 0x04034b50, 4), describe(f, crc[n], size[n], length), fputs(name, f);
        fwrite(npy, 1, size[n], f);
        free(npy);
    }
    uint32_t list = ftell(f);
    for (int n = 0; n < count; n++) {
        uint32_t length = snprintf(name, sizeof name, "%s.npy", arrays[n].name);
        put(f, 0x02014b50, 4), put(f, 20, 2), describe(f, crc[n], size[n], length);
        put(f, 0, 2), put(f, 0, 2), put(f, 0, 2), put(f, 0, 4), put(f, start[n], 4), fputs(name, f);
    }
    uint32_t behind = ftell(f);
    put(f, 0x06054b50, 4), put(f, 0, 4), put(f, count, 2), put(f, count, 2), put(f, behind - list, 4), put(f, list, 4), put(f, 0, 2);
    if (ferror(f) | fclose(f)) fail(file, "can't be written");
}

static Array *named(const char *file, Array *arrays, int count, const char *name) {
    for (int n = 0; n < count; n++)
        if (!strcmp(arrays[n].name, name)) return &arrays[n];
    fprintf(stderr, "%s: no f32 array %s; write the cases with --dtype f32\n", file, name);
    exit(2);
}

static Array zeros(const char *name, int dims, long rows, long columns) {
    Array a = {.dims = dims, .shape = {rows, columns}};
    strcpy(a.name, name);
    a.count = product(&a);
    a.data = calloc(a.count + 1, sizeof(float));
    return a;
}

/* The function under test: yours goes here. */
static void volume_render(long rays, long samples, const float *sigmas, const float *rgbs, const float *deltas, float *colors,
                          float *weights, float *opacity, float *transmittance) {
    for (long r = 0; r < rays; r++) {
        float depth = 0;
        for (long i = 0; i < samples; i++) {
            long k = r * samples + i;
            float x = sigmas[k] * deltas[k];
            weights[k] = expf(-depth) * -expm1f(-x);
            depth += x;
            for (int c = 0; c < 3; c++) colors[3 * r + c] += weights[k] * rgbs[3 * k + c];
            opacity[r] += weights[k];
        }
        transmittance[r] = expf(-depth);
    }
}

int main(int argc, char **argv) {
    if (argc != 3) fail("candidate", "expected: candidate CASES ANSWERS");
    char path[4096];
    glob_t files;
    snprintf(path, sizeof path, "%s/volume_render/forward-*.npz", argv[1]);
    if (glob(path, 0, NULL, &files)) fail(path, "no such cases");
    mkdir(argv[2], 0777);
    snprintf(path, sizeof path, "%s/volume_render", argv[2]);
    mkdir(path, 0777);
    for (size_t n = 0; n < files.gl_pathc; n++) {
        const char *file = files.gl_pathv[n];
        Array in[16];
        int count = read_npz(file, in, 16);
        Array *sigmas = named(file, in, count, "sigmas"), *rgbs = named(file, in, count, "rgbs");
        Array *deltas = named(file, in, count, "deltas");
        long rays = sigmas->shape[0], samples = sigmas->shape[1];
        Array out[4] = {zeros("colors", 2, rays, 3), zeros("weights", 2, rays, samples), zeros("opacity", 1, rays, 0),
                        zeros("transmittance", 1, rays, 0)};
        volume_render(rays, samples, sigmas->data, rgbs->data, deltas->data, out[0].data, out[1].data, out[2].data, out[3].data);
        snprintf(path, sizeof path, "%s/volume_render/%s", argv[2], strrchr(file, '/') + 1);
        write_npz(path, out, 4);
        for (int k = 0; k < count; k++) free(in[k].data);
        for (int k = 0; k < 4; k++) free(out[k].data);
    }
    printf("%zu cases answered\n", files.gl_pathc);
    globfree(&files);
    return 0;
}
