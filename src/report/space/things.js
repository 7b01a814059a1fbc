// Everything that is drawn, one object of three.js a layer, so that a thousand cameras cost as little as one.

const dark = matchMedia("(prefers-color-scheme: dark)").matches;
const INK = { train: [0.36, 0.45, 0.55], val: [0.9, 0.52, 0.1], hit: [0.35, 0.58, 0.82], miss: [0.85, 0.3, 0.3], box: dark ? 0x9aa5b1 : 0x66717d };

function geometry(positions, colors) {
  const made = new three.BufferGeometry();
  made.setAttribute("position", new three.Float32BufferAttribute(positions, 3));
  if (colors) made.setAttribute("color", new three.Float32BufferAttribute(colors, 3));
  return made;
}

const lines = (positions, colors, options = {}) =>
  new three.LineSegments(geometry(positions, colors), new three.LineBasicMaterial({ vertexColors: Boolean(colors), ...options }));
const dots = (positions, colors, size) =>
  new three.Points(geometry(positions, colors), new three.PointsMaterial({ vertexColors: true, size, sizeAttenuation: false, transparent: true, depthWrite: false }));

/** Center and corners of a camera's picture plane: `corners` has upper left, upper right, lower right, lower left. */
const center = (f) => [...arrays.centers.subarray(3 * f, 3 * f + 3)];
const corner = (f, k) => [...arrays.corners.subarray(12 * f + 3 * k, 12 * f + 3 * k + 3)];

function frustum(f) {
  const ends = [0, 1, 2, 3].map((k) => corner(f, k));
  return ends.flatMap((end, k) => [...center(f), ...end, ...end, ...ends[(k + 1) % 4]]);
}

function cameras() {
  const positions = frames.flatMap((_, f) => frustum(f));
  const colors = frames.flatMap((frame) => Array(16).fill(frame.val ? INK.val : INK.train).flat());
  return lines(positions, colors);
}

/** All photographs as one mesh over one picture. */
function photographs(atlas) {
  const [positions, places, index] = [[], [], []];
  const { columns, rows } = data.atlas;
  frames.forEach((_, f) => {
    const [x, y] = [f % columns, Math.floor(f / columns)];
    for (let k = 0; k < 4; k++) positions.push(...corner(f, k));
    // Half a texel inside, so that no neighbor shows at the edges.
    const [a, b] = [0.5 / data.atlas.width, 0.5 / data.atlas.height];
    const [u0, u1, v0, v1] = [x / columns + a, (x + 1) / columns - a, 1 - y / rows - b, 1 - (y + 1) / rows + b];
    places.push(u0, v0, u1, v0, u1, v1, u0, v1);
    index.push(...[0, 1, 2, 0, 2, 3].map((i) => 4 * f + i));
  });
  const made = geometry(positions);
  made.setAttribute("uv", new three.Float32BufferAttribute(places, 2));
  made.setIndex(index);
  const map = new three.Texture(atlas);
  map.generateMipmaps = false;
  map.minFilter = three.LinearFilter;
  map.needsUpdate = true;
  return new three.Mesh(made, new three.MeshBasicMaterial({ map, side: three.DoubleSide }));
}

function rayLines() {
  const [positions, colors] = [[], []];
  for (let r = 0; r < rays; r++) {
    positions.push(...vector("rays_o", r), ...point(r, data.far));
    const color = arrays.rays_hit[r] ? INK.hit : INK.miss;
    colors.push(...color, ...color);
  }
  return lines(positions, colors, { transparent: true, opacity: 0.55 });
}

/** How samples are colored: the share of each from 0 to 1, or its color. */
const BY = {
  weight: { name: "weight", of: "weights" },
  density: { name: "density", of: "sigmas" },
  color: { name: "color" },
};

/** The faintest sample: where nothing is, hardly anything shows, so that what is somewhere does. */
const FAINT = 0.1;

function sampleColors(by) {
  const colors = new Float32Array(rays * samples * 4);
  const values = arrays[BY[by].of];
  const opaque = values ?? arrays.weights;
  const most = opaque ? opaque.reduce((most, x) => Math.max(most, x), 0) || 1 : 1;
  for (let n = 0; n < rays * samples; n++) {
    const color = values ? shade(values[n] / most) : hasField ? arrays.rgbs.subarray(3 * n, 3 * n + 3) : vector("rays_rgb", Math.floor(n / samples));
    colors.set(color, 4 * n);
    colors[4 * n + 3] = opaque ? FAINT + (1 - FAINT) * Math.sqrt(opaque[n] / most) : 1;
  }
  return { colors, most: values ? most : undefined };
}

function sampleDots() {
  const positions = new Float32Array(rays * samples * 3);
  for (let r = 0; r < rays; r++) {
    for (let n = 0; n < samples; n++) positions.set(point(r, arrays.t[r * samples + n]), 3 * (r * samples + n));
  }
  return dots(positions, new Float32Array(rays * samples * 3), 4 * ratio);
}

/** The twelve edges of a box. */
function box([low, high]) {
  const at = (k) => [0, 1, 2].map((a) => ((k >> a) & 1 ? high[a] : low[a]));
  const positions = [];
  for (let k = 0; k < 8; k++) {
    for (let a = 0; a < 3; a++) if (!((k >> a) & 1)) positions.push(...at(k), ...at(k | (1 << a)));
  }
  return lines(positions, undefined, { color: INK.box });
}

/** The faces between occupied cells and empty ones. */
function cells({ low, high, resolution: r, bits }) {
  const words = bytes(bits);
  const occupied = (at) => at.every((i) => i >= 0 && i < r) && (words[((at[2] * r + at[1]) * r + at[0]) >> 3] >> (((at[2] * r + at[1]) * r + at[0]) & 7)) & 1;
  const [positions, index, colors] = [[], [], []];
  const face = (at, axis, side) => {
    const first = positions.length / 3;
    for (const [u, v] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
      const corner = [...at];
      corner[axis] += side;
      corner[(axis + 1) % 3] += u;
      corner[(axis + 2) % 3] += v;
      positions.push(...corner.map((i, a) => low[a] + (i / r) * (high[a] - low[a])));
      // Faces of one axis have one lightness, so that edges show without a light.
      colors.push(...[0.2, 0.62, 0.56].map((c) => c * [0.8, 1, 1.25][axis]));
    }
    index.push(first, first + 1, first + 2, first, first + 2, first + 3);
  };
  for (let n = 0; n < r ** 3; n++) {
    const at = [n % r, Math.floor(n / r) % r, Math.floor(n / r / r)];
    if (!occupied(at)) continue;
    for (let axis = 0; axis < 3; axis++) {
      for (const side of [0, 1]) {
        const beside = [...at];
        beside[axis] += 2 * side - 1;
        if (!occupied(beside)) face(at, axis, side);
      }
    }
  }
  const made = geometry(positions, colors);
  made.setIndex(index);
  return new three.Mesh(made, new three.MeshBasicMaterial({ vertexColors: true, side: three.DoubleSide, transparent: true, opacity: 0.16, depthWrite: false }));
}

const AXES = [["x", "#d64545"], ["y", "#2e9e5b"], ["z", "#3d7fe0"]];

function axes(length) {
  const positions = [0, 1, 2].flatMap((a) => [0, 0, 0, ...[0, 1, 2].map((b) => (a === b ? length : 0))]);
  const colors = AXES.flatMap(([, css]) => Array(2).fill(new three.Color(css).toArray()).flat());
  return lines(positions, colors);
}
