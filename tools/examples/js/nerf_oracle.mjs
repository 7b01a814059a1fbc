// Cases and answers of nerf-oracle in the raw layout, for JavaScript (node, no packages).
//
//     nerf-oracle cases volume_render --layout raw --dtype f32 --out cases
//
// `answer` reads each case of a component in one direction (forward, vjp, trace), hands its arrays to a function, and writes the arrays that
// the function returns. An array is { shape, data }: rows first, `data` a typed array.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const TYPES = { f64: Float64Array, f32: Float32Array, i64: BigInt64Array, u8: Uint8Array, f16: Uint16Array };

/** The arrays that a folder's index.txt lists; a line is `name dtype ndim sizes file`. */
export function read(folder) {
  const arrays = {};
  for (const line of readFileSync(join(folder, "index.txt"), "utf8").trim().split("\n").filter(Boolean)) {
    const [name, dtype, ndim, ...rest] = line.split(" ");
    const file = readFileSync(join(folder, rest[Number(ndim)]));
    const bytes = file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength);
    arrays[name] = { shape: rest.slice(0, Number(ndim)).map(Number), data: new TYPES[dtype](bytes) };
  }
  return arrays;
}

/** Writes arrays, and their index last. */
export function write(folder, arrays) {
  mkdirSync(folder, { recursive: true });
  const lines = Object.entries(arrays).map(([name, { shape, data }]) => {
    const dtype = Object.keys(TYPES).find((dtype) => data instanceof TYPES[dtype]);
    if (!dtype || shape.reduce((n, size) => n * size, 1) !== data.length) {
      throw new Error(`${folder}: ${name}: ${data.length} elements for [${shape}], in a ${data.constructor.name}`);
    }
    writeFileSync(join(folder, `${name}.bin`), data);
    return [name, dtype, shape.length, ...shape, `${name}.bin`].join(" ") + "\n";
  });
  writeFileSync(join(folder, "index.txt"), lines.join(""));
}

/** Hands every case of a component and kind to `ask(arrays)`, and writes what it returns below `answers`. Returns how many there were. */
export function answer(cases, answers, component, kind, ask) {
  const lines = readFileSync(join(cases, "cases.txt"), "utf8").trim().split("\n").map((line) => line.split(" "));
  const asked = lines.filter(([name, direction]) => name === component && direction === kind);
  for (const [, , , place] of asked) write(join(answers, place), ask(read(join(cases, place))));
  return asked.length;
}
