/* Volume rendering in C, f32, forward and its gradient, handed to the judge:
 *
 *     nerf-oracle cases volume_render --layout raw --out cases
 *     cc -O2 volume_render.c -o volume_render -lm && ./volume_render cases answers
 *     nerf-oracle judge cases answers
 *
 * `render` and `render_back` are the code under test: yours goes there. With -DINCLUSIVE they have a mistake, which the judge names. */
#include "nerf_oracle.h"

#include <math.h>

/* w_i = T_i (1 - exp(-x_i)), T_i = exp(-(x_0 + ... + x_(i-1))), x = sigma delta; C = sum w_i c_i. */
static void render(long rays, long samples, const float *sigmas, const float *rgbs, const float *deltas, float *colors, float *weights,
                   float *opacity, float *transmittance) {
    for (long r = 0; r < rays; r++) {
        float depth = 0;
        for (long i = r * samples; i < (r + 1) * samples; i++) {
            float x = sigmas[i] * deltas[i];
#ifdef INCLUSIVE
            weights[i] = expf(-(depth + x)) * -expm1f(-x);
#else
            weights[i] = expf(-depth) * -expm1f(-x);
#endif
            depth += x;
            for (int a = 0; a < 3; a++) colors[3 * r + a] += weights[i] * rgbs[3 * i + a];
            opacity[r] += weights[i];
        }
        transmittance[r] = expf(-depth);
    }
}

/* With g_i = dL/dw_i: dL/dx_i = T_(i+1) g_i - (sum of w_j g_j behind i) - T_N dL/dT_N, from the last sample to the first. */
static void render_back(long rays, long samples, const float *sigmas, const float *rgbs, const float *deltas, const float *grad_colors,
                        const float *grad_weights, const float *grad_opacity, const float *grad_transmittance, float *grad_sigmas,
                        float *grad_rgbs, float *grad_deltas) {
    for (long r = 0; r < rays; r++) {
        const float *gc = grad_colors + 3 * r;
        float depth = 0;
        for (long i = r * samples; i < (r + 1) * samples; i++) depth += sigmas[i] * deltas[i];
        float behind = expf(-depth) * grad_transmittance[r];
        for (long i = (r + 1) * samples - 1; i >= r * samples; i--) {
            const float *c = rgbs + 3 * i;
            float x = sigmas[i] * deltas[i], before = 0;
            for (long j = r * samples; j < i; j++) before += sigmas[j] * deltas[j];
            float after = expf(-(before + x));
#ifdef INCLUSIVE
            float weight = after * -expm1f(-x), slope = after * expf(-x) - weight;
#else
            float weight = expf(-before) * -expm1f(-x), slope = after;
#endif
            float g = gc[0] * c[0] + gc[1] * c[1] + gc[2] * c[2] + grad_weights[i] + grad_opacity[r];
            float grad_x = slope * g - behind;
            behind += weight * g;
            for (int a = 0; a < 3; a++) grad_rgbs[3 * i + a] = weight * gc[a];
            grad_sigmas[i] = deltas[i] * grad_x;
            grad_deltas[i] = sigmas[i] * grad_x;
        }
    }
}

static void forward(no_case *c) {
    const no_array *sigmas = no_input(c, "sigmas");
    long rays = sigmas->shape[0], samples = sigmas->shape[1];
    float *colors = no_output_f32(c, "colors", 2, rays, 3L), *weights = no_output_f32(c, "weights", 2, rays, samples);
    float *opacity = no_output_f32(c, "opacity", 1, rays), *transmittance = no_output_f32(c, "transmittance", 1, rays);
    render(rays, samples, no_f32(c, "sigmas"), no_f32(c, "rgbs"), no_f32(c, "deltas"), colors, weights, opacity, transmittance);
}

static void vjp(no_case *c) {
    const no_array *sigmas = no_input(c, "sigmas");
    long rays = sigmas->shape[0], samples = sigmas->shape[1];
    float *grad_sigmas = no_output_f32(c, "grad_sigmas", 2, rays, samples), *grad_rgbs = no_output_f32(c, "grad_rgbs", 3, rays, samples, 3L);
    float *grad_deltas = no_output_f32(c, "grad_deltas", 2, rays, samples);
    render_back(rays, samples, no_f32(c, "sigmas"), no_f32(c, "rgbs"), no_f32(c, "deltas"), no_f32(c, "grad_colors"),
                no_f32(c, "grad_weights"), no_f32(c, "grad_opacity"), no_f32(c, "grad_transmittance"), grad_sigmas, grad_rgbs, grad_deltas);
}

int main(int argc, char **argv) {
    if (argc != 3) no_fail("volume_render", "expected: volume_render CASES ANSWERS", "");
    long answered = no_answer(argv[1], argv[2], "volume_render", "forward", forward);
    answered += no_answer(argv[1], argv[2], "volume_render", "vjp", vjp);
    printf("%ld cases answered\n", answered);
    return answered ? 0 : 2;
}
