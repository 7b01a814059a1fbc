// The eye: it circles a target with the scene's own "up", by mouse, fingers and keys.

const camera = new three.PerspectiveCamera(40, 1, 0.01, 100);
const up = new three.Vector3(...data.view.up);
const target = new three.Vector3();

function place(eye, at) {
  camera.up.copy(up);
  camera.position.copy(eye);
  target.copy(at);
  aim();
}

/** Near and far by the distance to what is looked at: it may be a table or a town. */
function aim() {
  const away = camera.position.distanceTo(target);
  [camera.near, camera.far] = [away / 500, away * 50 + data.extent * 4];
  camera.lookAt(target);
  camera.updateProjectionMatrix();
  redraw();
}

/** Everything, from farther away where the stage is narrow. */
function home() {
  const [eye, at] = [new three.Vector3(...data.view.eye), new three.Vector3(...data.view.target)];
  place(eye.sub(at).multiplyScalar(Math.max(1, 1.15 / camera.aspect)).add(at), at);
}

/** Turns by angles: around "up", and toward it, never over the pole. */
function turn(around, above) {
  const offset = camera.position.clone().sub(target);
  offset.applyAxisAngle(up, around);
  const side = up.clone().cross(offset).normalize();
  const angle = offset.angleTo(up);
  offset.applyAxisAngle(side, Math.min(Math.max(angle + above, 0.05), Math.PI - 0.05) - angle);
  camera.position.copy(target).add(offset);
  aim();
}

function zoom(factor) {
  const away = camera.position.distanceTo(target);
  const wanted = Math.min(Math.max(away * factor, data.extent * 1e-3), data.extent * 20);
  camera.position.sub(target).multiplyScalar(wanted / away).add(target);
  aim();
}

/** Moves along the picture, by pixels. */
function shift(x, y) {
  const scale = (2 * Math.tan((camera.fov * Math.PI) / 360) * camera.position.distanceTo(target)) / view.clientHeight;
  const right = new three.Vector3().setFromMatrixColumn(camera.matrix, 0).multiplyScalar(-x * scale);
  const above = new three.Vector3().setFromMatrixColumn(camera.matrix, 1).multiplyScalar(y * scale);
  for (const moved of [camera.position, target]) moved.add(right).add(above);
  aim();
}

const fingers = new Map();
let dragged = 0;

function spread() {
  const [a, b] = [...fingers.values()];
  return { middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], apart: Math.hypot(a[0] - b[0], a[1] - b[1]) };
}

view.addEventListener("pointerdown", (event) => {
  if (fingers.size === 0) dragged = 0;
  fingers.set(event.pointerId, [event.clientX, event.clientY]);
  // Not every pointer can be captured, and none needs to be.
  try { view.setPointerCapture(event.pointerId); } catch { /* it goes on without */ }
});
view.addEventListener("pointermove", (event) => {
  const last = fingers.get(event.pointerId);
  if (!last) return;
  const [x, y] = [event.clientX - last[0], event.clientY - last[1]];
  dragged += Math.abs(x) + Math.abs(y);
  const before = fingers.size === 2 && spread();
  fingers.set(event.pointerId, [event.clientX, event.clientY]);
  if (before) {
    const after = spread();
    shift(after.middle[0] - before.middle[0], after.middle[1] - before.middle[1]);
    zoom(before.apart / Math.max(after.apart, 1));
  } else if (event.shiftKey || event.buttons & 6) {
    shift(x, y);
  } else {
    turn((-x * Math.PI) / view.clientHeight, (-y * Math.PI) / view.clientHeight);
  }
});
for (const end of ["pointerup", "pointercancel"]) {
  view.addEventListener(end, (event) => {
    const alone = fingers.size === 1;
    fingers.delete(event.pointerId);
    // A click, and no drag that ends.
    if (end === "pointerup" && alone && dragged < 5 && event.button === 0) pick(event.offsetX, event.offsetY);
  });
}
view.addEventListener("contextmenu", (event) => event.preventDefault());
view.addEventListener("wheel", (event) => {
  event.preventDefault();
  zoom(Math.exp(Math.min(Math.max(event.deltaY, -100), 100) * 0.0015));
}, { passive: false });

const KEYS = {
  ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
  "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1.1), Home: home,
};
view.addEventListener("keydown", (event) => {
  if (!KEYS[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  KEYS[event.key]();
});
