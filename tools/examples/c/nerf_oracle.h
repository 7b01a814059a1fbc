/* Cases and answers of nerf-oracle in the raw layout, for C99, C++11 and CUDA; this file is all that it takes.
 *
 *     nerf-oracle cases volume_render --layout raw --dtype f32 --out cases
 *
 *     #include "nerf_oracle.h"
 *     static void answer(no_case *c) {
 *         const no_array *sigmas = no_input(c, "sigmas");
 *         long rays = sigmas->shape[0], samples = sigmas->shape[1];
 *         float *colors = no_output_f32(c, "colors", 2, rays, 3L);
 *         my_kernel(rays, samples, no_f32(c, "sigmas"), ..., colors);
 *     }
 *     int main(void) { return no_answer("cases", "answers", "volume_render", "forward", answer) < 1; }
 *
 *     nerf-oracle judge cases answers
 *
 * `no_answer` reads each case of a component in one direction (forward, vjp, trace), hands it to the function, and writes the outputs that the
 * function made. Arrays are rows first. Whatever is wrong ends the program with exit code 2 and a line that says what. */
#ifndef NERF_ORACLE_H
#define NERF_ORACLE_H

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <direct.h>
#define no_mkdir(path) _mkdir(path)
#define no_slash(c) ((c) == '/' || (c) == '\\')
#else
#include <sys/stat.h>
#define no_mkdir(path) mkdir(path, 0777)
#define no_slash(c) ((c) == '/')
#endif

enum { NO_NAME = 96, NO_DIMS = 8, NO_ARRAYS = 500, NO_PATH = 4096 };

typedef struct {
    char name[NO_NAME], dtype[8]; /* f64, f32, f16, i64, u8 */
    int dims;                     /* 0: a scalar */
    long shape[NO_DIMS], count;   /* count: the product of the sizes */
    void *data;
} no_array;

typedef struct {
    char component[NO_NAME], kind[NO_NAME], id[2 * NO_NAME], folder[NO_PATH];
    int inputs, outputs;
    no_array input[NO_ARRAYS], output[NO_ARRAYS];
} no_case;

static inline void no_fail(const char *where, const char *what, const char *name) {
    fprintf(stderr, "%s: %s%s\n", where, what, name);
    exit(2);
}

static inline long no_item(const char *dtype) {
    return !strcmp(dtype, "f64") || !strcmp(dtype, "i64") ? 8 : !strcmp(dtype, "f32") ? 4 : !strcmp(dtype, "f16") ? 2 : 1;
}

static inline void no_join(char *path, const char *folder, const char *name, const char *extension) {
    if (snprintf(path, NO_PATH, "%s/%s%s", folder, name, extension) >= NO_PATH) no_fail(folder, "the path is too long: ", name);
}

/* Makes a folder, and what it lies in. That it can't be made shows when a file is opened in it. */
static inline void no_folder(const char *folder) {
    char path[NO_PATH];
    int n;
    no_join(path, folder, "", "");
    for (n = 1; path[n]; n++)
        if (no_slash(path[n])) {
            path[n] = 0;
            no_mkdir(path);
            path[n] = '/';
        }
}

/* The arrays that a folder's index.txt lists; a line is `name dtype ndim sizes file`. Returns how many. */
static inline int no_read(const char *folder, no_array *arrays) {
    char path[NO_PATH], file[NO_NAME + 4];
    int found = 0, d;
    no_join(path, folder, "index", ".txt");
    FILE *index = fopen(path, "r"), *numbers;
    if (!index) no_fail(path, "can't be read; write the cases in the raw layout", "");
    for (;; found++) {
        no_array *a = &arrays[found], line;
        if (fscanf(index, "%95s %7s %d", line.name, line.dtype, &line.dims) != 3) break;
        if (found == NO_ARRAYS) no_fail(path, "too many arrays", "");
        *a = line;
        if (a->dims < 0 || a->dims > NO_DIMS) no_fail(path, "too many dimensions: ", a->name);
        for (d = 0, a->count = 1; d < a->dims; d++) {
            if (fscanf(index, "%ld", &a->shape[d]) != 1 || a->shape[d] < 0) no_fail(path, "no size: ", a->name);
            a->count *= a->shape[d];
        }
        if (fscanf(index, "%99s", file) != 1) no_fail(path, "no file: ", a->name);
        size_t bytes = (size_t)(a->count * no_item(a->dtype));
        a->data = calloc(bytes + 1, 1);
        no_join(path, folder, file, "");
        numbers = fopen(path, "rb");
        if (!a->data || !numbers || fread(a->data, 1, bytes, numbers) != bytes) no_fail(path, "can't be read to its end", "");
        fclose(numbers);
    }
    fclose(index);
    return found;
}

static inline void no_write(const char *folder, const no_array *arrays, int count) {
    char path[NO_PATH];
    int n, d;
    no_folder(folder);
    no_join(path, folder, "index", ".txt");
    FILE *index = fopen(path, "w"), *numbers;
    if (!index) no_fail(path, "can't be written", "");
    for (n = 0; n < count; n++) {
        const no_array *a = &arrays[n];
        size_t bytes = (size_t)(a->count * no_item(a->dtype));
        fprintf(index, "%s %s %d", a->name, a->dtype, a->dims);
        for (d = 0; d < a->dims; d++) fprintf(index, " %ld", a->shape[d]);
        fprintf(index, " %s.bin\n", a->name);
        no_join(path, folder, a->name, ".bin");
        numbers = fopen(path, "wb");
        if (!numbers || fwrite(a->data, 1, bytes, numbers) != bytes) no_fail(path, "can't be written", "");
        if (fclose(numbers)) no_fail(path, "can't be written", "");
    }
    if (fclose(index)) no_fail(folder, "its index can't be written", "");
}

/* The input of this name, or NULL. */
static inline const no_array *no_find(const no_case *c, const char *name) {
    int n;
    for (n = 0; n < c->inputs; n++)
        if (!strcmp(c->input[n].name, name)) return &c->input[n];
    return NULL;
}

static inline const no_array *no_input(const no_case *c, const char *name) {
    const no_array *a = no_find(c, name);
    if (!a) no_fail(c->folder, "no array ", name);
    return a;
}

/* The numbers of an input, if they are of this type. */
static inline const void *no_typed(const no_case *c, const char *name, const char *dtype) {
    const no_array *a = no_input(c, name);
    if (strcmp(a->dtype, dtype)) {
        fprintf(stderr, "%s: %s is %s, and %s was asked for; write the cases in that type\n", c->folder, name, a->dtype, dtype);
        exit(2);
    }
    return a->data;
}
static inline const float *no_f32(const no_case *c, const char *name) { return (const float *)no_typed(c, name, "f32"); }
static inline const double *no_f64(const no_case *c, const char *name) { return (const double *)no_typed(c, name, "f64"); }
static inline const int64_t *no_i64(const no_case *c, const char *name) { return (const int64_t *)no_typed(c, name, "i64"); }

/* A new output, all 0, with as many sizes (long) as it has dimensions. */
static inline void *no_output(no_case *c, const char *name, const char *dtype, int dims, va_list sizes) {
    if (c->outputs == NO_ARRAYS || dims > NO_DIMS || strlen(name) >= NO_NAME) no_fail(c->folder, "too large an output: ", name);
    no_array *a = &c->output[c->outputs++];
    strcpy(a->name, name);
    strcpy(a->dtype, dtype);
    a->dims = dims;
    a->count = 1;
    for (int d = 0; d < dims; d++) {
        a->shape[d] = va_arg(sizes, long);
        a->count *= a->shape[d];
    }
    a->data = calloc((size_t)a->count + 1, (size_t)no_item(dtype));
    if (!a->data) no_fail(c->folder, "no memory for ", name);
    return a->data;
}
static inline float *no_output_f32(no_case *c, const char *name, int dims, ...) {
    va_list sizes;
    va_start(sizes, dims);
    float *data = (float *)no_output(c, name, "f32", dims, sizes);
    va_end(sizes);
    return data;
}
static inline double *no_output_f64(no_case *c, const char *name, int dims, ...) {
    va_list sizes;
    va_start(sizes, dims);
    double *data = (double *)no_output(c, name, "f64", dims, sizes);
    va_end(sizes);
    return data;
}

static inline void no_free(no_array *arrays, int count) {
    while (count--) free(arrays[count].data);
}

/* Hands every case of a component and kind to `function`, and writes its outputs below `answers` (NULL: nothing is written). Returns how
 * many cases there were; of each, one without outputs is left unanswered. */
static inline long no_answer(const char *cases, const char *answers, const char *component, const char *kind, void (*function)(no_case *)) {
    const uint16_t one = 1;
    char path[NO_PATH], place[NO_PATH];
    long found = 0;
    if (*(const unsigned char *)&one != 1) no_fail(cases, "the numbers are little-endian, and this machine isn't", "");
    no_join(path, cases, "cases", ".txt");
    FILE *list = fopen(path, "r");
    if (!list) no_fail(path, "can't be read; write the cases in the raw layout", "");
    no_case *c = (no_case *)calloc(1, sizeof *c);
    if (!c) no_fail(cases, "no memory", "");
    while (fscanf(list, "%95s %95s %191s %4095s", c->component, c->kind, c->id, place) == 4) {
        if (strcmp(c->component, component) || strcmp(c->kind, kind)) continue;
        no_join(c->folder, cases, place, "");
        c->inputs = no_read(c->folder, c->input);
        c->outputs = 0;
        function(c);
        if (answers && c->outputs) {
            no_join(path, answers, place, "");
            no_write(path, c->output, c->outputs);
        }
        no_free(c->input, c->inputs);
        no_free(c->output, c->outputs);
        found++;
    }
    fclose(list);
    free(c);
    return found;
}

#endif
