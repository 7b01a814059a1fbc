// What was clicked: the camera whose center, or the ray whose line, is nearest to the click on the screen.

/** How near a click must be, in pixels. */
const REACH = 12;

function onScreen(at) {
  const seen = new three.Vector3(...at).applyMatrix4(camera.matrixWorldInverse);
  if (seen.z > -camera.near) return undefined;
  seen.applyMatrix4(camera.projectionMatrix);
  return [((seen.x + 1) / 2) * view.clientWidth, ((1 - seen.y) / 2) * view.clientHeight];
}

function toSegment([x, y], a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const share = Math.min(Math.max(((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy || 1), 0), 1);
  return Math.hypot(x - a[0] - share * dx, y - a[1] - share * dy);
}

/** A ray from where its samples begin, so that cameras can be picked where many rays start. */
function rayDistance(click, r) {
  const [a, b] = [onScreen(point(r, data.near)), onScreen(point(r, data.far))];
  return a && b ? toSegment(click, a, b) : Infinity;
}

function cameraDistance(click, f) {
  const [a, ...ends] = [center(f), ...[0, 1, 2, 3].map((k) => corner(f, k))].map(onScreen);
  if (!a || ends.some((end) => !end)) return Infinity;
  return Math.min(...ends.map((end, k) => Math.min(toSegment(click, a, end), toSegment(click, end, ends[(k + 1) % 4]))));
}

function nearest(count, distance) {
  let best = { at: -1, distance: REACH };
  for (let n = 0; n < count; n++) {
    const away = distance(n);
    if (away < best.distance) best = { at: n, distance: away };
  }
  return best;
}

function pick(x, y) {
  const shot = layers.cameras.visible ? nearest(frames.length, (f) => cameraDistance([x, y], f)) : { at: -1 };
  const ray = layers.rays.visible ? nearest(rays, (r) => rayDistance([x, y], r)) : { at: -1 };
  if (shot.at >= 0 && (ray.at < 0 || shot.distance <= ray.distance)) chooseCamera(shot.at);
  else if (ray.at >= 0) chooseRay(ray.at);
}
