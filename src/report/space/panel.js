// Beside the view: what is known of the chosen camera and of the chosen ray, stage by stage.

function list(id, facts) {
  $(id).replaceChildren(...facts.flatMap(([name, value]) => {
    const shown = element("dd");
    shown.append(...[value].flat());
    return [element("dt", name), shown];
  }));
}

const triple = (values) => [...values].map(figure).join(", ");

/** A color as numbers, with a patch of it. */
function colored(rgb) {
  const patch = element("span", "", { class: "swatch", "aria-hidden": "true" });
  patch.style.background = css([...rgb]);
  return [patch, ` ${triple(rgb)}`];
}

const chosen = { camera: -1, ray: -1 };

function chooseCamera(f) {
  chosen.camera = f;
  $("camera").value = String(f);
  const [fx, fy, cx, cy] = arrays.intrinsics.subarray(4 * f, 4 * f + 4);
  list("of-camera", [
    ["frame", `${frames[f].name} (${frames[f].val ? "to measure on" : "to learn from"})`],
    ["size", `${arrays.sizes[2 * f]} x ${arrays.sizes[2 * f + 1]}`],
    ["fx, fy", triple([fx, fy])],
    ["cx, cy", triple([cx, cy])],
    ["center", triple(center(f))],
    ["looks along", triple(arrays.axes.subarray(3 * f, 3 * f + 3))],
    ...(frames[f].doubt ? [["doubt", frames[f].doubt]] : []),
  ]);
  showPhoto(f);
  mark("camera", lines(frustum(f), undefined, { color: 0xff3d7f, depthTest: false }));
}

function showPhoto(f) {
  const [canvas, { columns, width, height }] = [$("photo"), data.atlas];
  [canvas.width, canvas.height] = [width, height];
  canvas.style.width = `${Math.max(width, 200)}px`;
  canvas.setAttribute("aria-label", `Photograph of ${frames[f].name}, small`);
  canvas.getContext("2d").drawImage(atlas, (f % columns) * width, Math.floor(f / columns) * height, width, height, 0, 0, width, height);
  canvas.hidden = false;
}

/** The eye where the camera stands. */
function through() {
  const f = Math.max(chosen.camera, 0);
  const [at, along] = [new three.Vector3(...center(f)), new three.Vector3(...arrays.axes.subarray(3 * f, 3 * f + 3))];
  // A little behind, so that its own frustum is in the picture.
  place(at.clone().addScaledVector(along, -0.08 * data.extent), at.clone().addScaledVector(along, data.focal_distance));
}

function chooseRay(r) {
  chosen.ray = r;
  $("ray").value = String(r);
  const facts = [
    ["frame", frames[arrays.rays_frame[r]].name],
    ["uv", triple(ofRay("rays_uv", r, 2))],
    ["o", triple(vector("rays_o", r))],
    ["d", triple(vector("rays_d", r))],
    ["photograph", colored(vector("rays_rgb", r))],
  ];
  if (hasField) {
    facts.push(["rendered", colored(vector("colors", r))], ["opacity A", figure(arrays.opacities[r])]);
  }
  if (!hasField) facts.push(["field", "unknown of photographs alone; inspect --run RUN shows that of a trained run"]);
  if (data.box) facts.push(["scene's box", arrays.rays_hit[r] ? "is met between near and far" : "is missed"]);
  list("of-ray", facts);
  $("plot").innerHTML = plot(r);
  $("samples").replaceChildren(sampleTable(r));
  showHeaviest(r);
  const segment = [...vector("rays_o", r), ...point(r, data.far)];
  mark("ray", lines(segment, undefined, { color: 0xff3d7f, depthTest: false }));
}

/** The sample that the ray's color is most of, in the middle of what the table shows. */
function showHeaviest(r) {
  if (!hasField) return;
  const weights = ofRay("weights", r, samples);
  const row = $("samples").querySelectorAll("tbody tr")[weights.indexOf(Math.max(...weights))];
  row.className = "heaviest";
  $("samples").scrollTop = row.offsetTop - $("samples").clientHeight / 2;
}

/** The columns of the table: a heading, and the value of a sample. */
const COLUMNS = [["t", "t"], ["δ", "deltas"], ["σ", "sigmas"], ["α", "alphas"], ["T", "transmittances"], ["w", "weights"]];

function sampleTable(r) {
  const table = element("table");
  const columns = COLUMNS.filter(([, name]) => arrays[name]);
  const head = table.createTHead().insertRow();
  for (const name of ["i", ...columns.map(([name]) => name), ...(hasField ? ["color c"] : [])]) head.append(element("th", name, { scope: "col" }));
  const body = table.createTBody();
  for (let n = 0; n < samples; n++) {
    const row = body.insertRow();
    row.append(element("td", String(n)), ...columns.map(([, name]) => element("td", figure(arrays[name][r * samples + n]))));
    if (hasField) {
      const cell = element("td");
      cell.append(...colored(ofRay("rgbs", r * samples + n, 3)));
      row.append(cell);
    }
  }
  return table;
}
