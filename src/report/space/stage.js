// The stage: what draws, when something has changed, never else.

three.ColorManagement.enabled = false;
const view = $("view");
const ratio = Math.min(devicePixelRatio, 2);
const scene = new three.Scene();
const marks = {};
let [renderer, due] = [undefined, false];

/** Draws at the next frame. */
function redraw() {
  if (due) return;
  due = true;
  requestAnimationFrame(() => {
    due = false;
    draw();
  });
}

function draw() {
  if (!renderer) return;
  renderer.render(scene, camera);
  labels.forEach(([label, at]) => {
    const seen = layers.axes.visible && onScreen(at);
    label.hidden = !seen;
    if (seen) label.style.transform = `translate(${seen[0] + 4}px, ${seen[1] - 10}px)`;
  });
}

function mark(name, object) {
  if (marks[name]) {
    scene.remove(marks[name]);
    marks[name].geometry.dispose();
    marks[name].material.dispose();
  }
  object.renderOrder = 2;
  marks[name] = object;
  scene.add(object);
  redraw();
}

function resize() {
  const { clientWidth: width, clientHeight: height } = $("stage");
  renderer?.setSize(width, height, false);
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  redraw();
}

function start() {
  try {
    renderer = new three.WebGLRenderer({ canvas: view, antialias: true, alpha: true });
  } catch {
    $("hint").textContent = "This browser shows no WebGL: the picture outside.png beside this page is the view that it would have.";
    return;
  }
  renderer.outputColorSpace = three.LinearSRGBColorSpace;
  renderer.setPixelRatio(ratio);
}
