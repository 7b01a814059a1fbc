// Volume rendering in CUDA, f32, forward: a thread a ray.
//
//     nerf-oracle cases volume_render --layout raw --out cases
//     nvcc -O2 volume_render.cu -o volume_render && ./volume_render cases answers
//     nerf-oracle judge cases answers
#include "nerf_oracle.h"

__global__ void render(long rays, long samples, const float *sigmas, const float *rgbs, const float *deltas, float *colors, float *weights,
                       float *opacity, float *transmittance) {
    long r = blockIdx.x * (long)blockDim.x + threadIdx.x;
    if (r >= rays) return;
    float depth = 0, color[3] = {0, 0, 0}, sum = 0;
    for (long i = r * samples; i < (r + 1) * samples; i++) {
        float x = sigmas[i] * deltas[i];
        float weight = expf(-depth) * -expm1f(-x);
        depth += x;
        for (int a = 0; a < 3; a++) color[a] += weight * rgbs[3 * i + a];
        weights[i] = weight;
        sum += weight;
    }
    for (int a = 0; a < 3; a++) colors[3 * r + a] = color[a];
    opacity[r] = sum;
    transmittance[r] = expf(-depth);
}

static void checked(cudaError_t error) {
    if (error != cudaSuccess) no_fail("volume_render", "CUDA: ", cudaGetErrorString(error));
}

// A copy on the device; one element more, so that there is something to allocate for a ray without samples.
static float *device(const float *host, long count) {
    float *copy;
    checked(cudaMalloc(&copy, (count + 1) * sizeof(float)));
    checked(cudaMemcpy(copy, host, count * sizeof(float), cudaMemcpyHostToDevice));
    return copy;
}

static void forward(no_case *c) {
    const no_array *sigmas = no_input(c, "sigmas");
    long rays = sigmas->shape[0], samples = sigmas->shape[1];
    float *in[3], *out[4];
    const char *names[3] = {"sigmas", "rgbs", "deltas"};
    for (int n = 0; n < 3; n++) in[n] = device(no_f32(c, names[n]), no_input(c, names[n])->count);
    float *host[4] = {no_output_f32(c, "colors", 2, rays, 3L), no_output_f32(c, "weights", 2, rays, samples),
                      no_output_f32(c, "opacity", 1, rays), no_output_f32(c, "transmittance", 1, rays)};
    for (int n = 0; n < 4; n++) out[n] = device(host[n], c->output[n].count);
    render<<<(unsigned)(rays / 64 + 1), 64>>>(rays, samples, in[0], in[1], in[2], out[0], out[1], out[2], out[3]);
    checked(cudaGetLastError());
    for (int n = 0; n < 4; n++) checked(cudaMemcpy(host[n], out[n], c->output[n].count * sizeof(float), cudaMemcpyDeviceToHost));
    for (int n = 0; n < 3; n++) checked(cudaFree(in[n]));
    for (int n = 0; n < 4; n++) checked(cudaFree(out[n]));
}

int main(int argc, char **argv) {
    if (argc != 3) no_fail("volume_render", "expected: volume_render CASES ANSWERS", "");
    long answered = no_answer(argv[1], argv[2], "volume_render", "forward", forward);
    printf("%ld cases answered\n", answered);
    return answered ? 0 : 2;
}
