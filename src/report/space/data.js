// What the page holds: a description in JSON, and arrays as f64 in base64, the very numbers of rays.npz.

const data = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);

const bytes = (base64) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));

// A zip of names to arrays; a name that the scene has no values for is undefined.
const arrays = Object.fromEntries(
  Object.entries(data.arrays).map(([name, base64]) => [name, new Float64Array(bytes(base64).buffer)]),
);
const [rays, samples] = [data.rays, data.samples];
const frames = data.frames;

/** The values of ray r: `wide` of them for a ray, or for each of its samples. */
const ofRay = (name, r, wide = 1) => arrays[name].subarray(r * wide, (r + 1) * wide);
const vector = (name, r) => ofRay(name, r, 3);
const point = (r, t) => [0, 1, 2].map((a) => vector("rays_o", r)[a] + vector("rays_d", r)[a] * t);
const hasField = arrays.sigmas !== undefined;

/** Stops of viridis: even steps of lightness, for every kind of eye. */
const STOPS = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37],
].map((stop) => stop.map((byte) => byte / 255));

/** The color of a share from 0 to 1. */
function shade(share) {
  const at = Math.min(Math.max(share, 0), 1) * (STOPS.length - 1);
  const low = Math.min(Math.floor(at), STOPS.length - 2);
  return [0, 1, 2].map((c) => STOPS[low][c] + (at - low) * (STOPS[low + 1][c] - STOPS[low][c]));
}

const css = (rgb) => `rgb(${rgb.map((x) => Math.round(255 * Math.min(Math.max(x, 0), 1))).join(" ")})`;

/** A number with seven digits, without zeros that say nothing. */
function figure(x) {
  if (!Number.isFinite(x)) return String(x);
  const text = x.toPrecision(7);
  return text.includes("e") ? text.replace(/\.?0+e/, "e") : text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/** An element with a text; nothing of the scene is ever read as HTML. */
function element(tag, text = "", attributes = {}) {
  const made = document.createElement(tag);
  made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}
