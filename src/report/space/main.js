// Puts everything together.

const atlas = new Image();
atlas.src = data.atlas.picture;
await atlas.decode();

const layers = { cameras: cameras(), photographs: photographs(atlas), rays: rayLines(), samples: sampleDots(), axes: axes(data.extent * 0.2) };
const LAYERS = { cameras: "cameras", photographs: "photographs", rays: "rays", samples: "samples", axes: "axes x y z" };
if (data.box) [layers.box, LAYERS.box] = [box(data.box), "scene's box"];
if (data.cells) [layers.cells, LAYERS.cells] = [cells(data.cells), "occupied cells"];
if (arrays.cloud) {
  const points = arrays.cloud;
  [layers.cloud, LAYERS.cloud] = [dots(points, new Float32Array(points.length).fill(0.5), 2 * ratio), "points of the capture"];
}
for (const layer of Object.values(layers)) scene.add(layer);
const labels = AXES.map(([name, color], a) => {
  const label = element("span", name, { class: "axis" });
  label.style.color = color;
  $("stage").append(label);
  return [label, [0, 1, 2].map((b) => (a === b ? data.extent * 0.2 : 0))];
});

function colorBy(by) {
  const { colors, most } = sampleColors(by);
  layers.samples.geometry.setAttribute("color", new three.BufferAttribute(colors, 4));
  const scale = $("scale");
  scale.hidden = most === undefined;
  if (most !== undefined) {
    const bar = element("i");
    bar.style.background = `linear-gradient(to right, ${STOPS.map(css).join(", ")})`;
    scale.replaceChildren(`${BY[by].name} 0 `, bar, ` ${figure(Number(most.toPrecision(3)))}`);
  }
  redraw();
}

/** A box to tick, or one of several to choose. */
function control(type, group, name, checked, changed) {
  const label = element("label");
  const input = element("input", "", { type, name: group });
  input.checked = checked;
  input.addEventListener("change", () => changed(input.checked));
  label.append(input, ` ${name}`);
  return label;
}

function panel() {
  document.title = data.title;
  $("title").textContent = data.title;
  if (data.warnings.length) {
    const warnings = element("ul", "", { class: "warnings" });
    warnings.append(...data.warnings.map((warning) => element("li", warning)));
    $("warnings").append(warnings);
  }
  list("facts", data.facts);
  $("layers").append(...Object.entries(LAYERS).map(([layer, name]) =>
    control("checkbox", layer, name, true, (on) => { layers[layer].visible = on; redraw(); })));
  const by = hasField ? ["weight", "density", "color"] : ["color"];
  $("colors").append(...by.map((by, n) => control("radio", "color-by", hasField ? BY[by].name : "the photograph's color", n === 0, () => colorBy(by))));
  $("camera").append(...frames.map((frame, f) => element("option", frame.name, { value: f })));
  $("ray").append(...Array.from({ length: rays }, (_, r) =>
    element("option", `ray ${r}: ${frames[arrays.rays_frame[r]].name}, pixel ${ofRay("rays_uv", r, 2).join(", ")}`, { value: r })));
  $("camera").addEventListener("change", () => chooseCamera(Number($("camera").value)));
  $("ray").addEventListener("change", () => chooseRay(Number($("ray").value)));
  $("through").addEventListener("click", through);
  $("before").addEventListener("click", () => chooseRay((chosen.ray + rays - 1) % rays));
  $("next").addEventListener("click", () => chooseRay((chosen.ray + 1) % rays));
}

start();
panel();
colorBy(hasField ? "weight" : "color");
resize();
home();
chooseCamera(0);
// The ray that sees most; any, where that isn't known.
chooseRay(hasField ? arrays.opacities.indexOf(Math.max(...arrays.opacities.subarray(0, rays))) : 0);
new ResizeObserver(resize).observe($("stage"));
draw();
// For whoever waits for the first picture, or measures it.
requestAnimationFrame(() => { document.documentElement.dataset.drawn = String(Math.round(performance.now())); });
