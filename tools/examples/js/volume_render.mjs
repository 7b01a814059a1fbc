// Volume rendering in JavaScript, forward, handed to the judge:
//
//     nerf-oracle cases volume_render --layout raw --dtype f32 --out cases
//     node volume_render.mjs cases answers
//     nerf-oracle judge cases answers
//
// `render` is the code under test: yours goes there. With a third argument, `inclusive`, it has a mistake for the judge to name.
import { answer } from "./nerf_oracle.mjs";

const [, , cases, answers, mistake] = process.argv;

/** w_i = T_i (1 - exp(-x_i)), T_i = exp(-(x_0 + ... + x_(i-1))), x = sigma delta; C = sum w_i c_i. */
function render({ sigmas, rgbs, deltas }) {
  const [rays, samples] = sigmas.shape;
  const zeros = (...shape) => ({ shape, data: new Float32Array(shape.reduce((n, size) => n * size, 1)) });
  const colors = zeros(rays, 3), weights = zeros(rays, samples), opacity = zeros(rays), transmittance = zeros(rays);
  for (let r = 0; r < rays; r++) {
    let depth = 0;
    for (let i = r * samples; i < (r + 1) * samples; i++) {
      const x = sigmas.data[i] * deltas.data[i];
      const light = Math.exp(-(mistake === "inclusive" ? depth + x : depth));
      weights.data[i] = light * -Math.expm1(-x);
      depth += x;
      for (let a = 0; a < 3; a++) colors.data[3 * r + a] += weights.data[i] * rgbs.data[3 * i + a];
      opacity.data[r] += weights.data[i];
    }
    transmittance.data[r] = Math.exp(-depth);
  }
  return { colors, weights, opacity, transmittance };
}

console.log(`${answer(cases, answers, "volume_render", "forward", render)} cases answered`);
