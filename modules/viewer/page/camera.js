// Vectors, matrices, and the point of view that the user moves. Matrices are columns first, as WebGL wants them.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => scale(a, 1 / (norm(a) || 1));
const mix = (a, b, t) => add(scale(a, 1 - t), scale(b, t));

/// Turns a vector by the quaternion that stands at 3 to 6 of a pose.
function turn(pose, v) {
  const q = [pose[3], pose[4], pose[5]], w = pose[6];
  const t = scale(cross(q, v), 2);
  return add(add(v, scale(t, w)), cross(q, t));
}
/// From the frame of a pose to the world.
const transform = (pose, v) => add(turn(pose, v), pose);

function multiply(a, b) {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; ++c)
    for (let r = 0; r < 4; ++r)
      for (let k = 0; k < 4; ++k) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
  return out;
}

/// Where the map is seen from: around a target, upright as the camera was carried.
class PointOfView {
  constructor() {
    this.up = [0, -1, 0];
    this.forward = [0, 0, 1];
    this.target = [0, 0, 2];
    this.yaw = Math.PI + 0.5;
    this.pitch = 0.55;
    this.distance = 6;
    this.mode = 'orbit';
    this.isFree = false;  // moved by the user: not fitted to the map any more
  }
  basis() {
    const first = unit(subtract(this.forward, scale(this.up, dot(this.forward, this.up))));
    return [first, cross(this.up, first)];
  }
  direction() {
    const [a, b] = this.basis();
    const pitch = this.mode === 'top' ? Math.PI / 2 - 1e-3 : this.pitch;
    return add(scale(add(scale(a, Math.cos(this.yaw)), scale(b, Math.sin(this.yaw))), Math.cos(pitch)), scale(this.up, Math.sin(pitch)));
  }
  eye() { return add(this.target, scale(this.direction(), this.distance)); }
  axes() {
    const back = this.direction();
    const right = unit(cross(this.up, back));
    return [right, cross(back, right), back];
  }
  /// From the world to clip space.
  matrix(aspect) {
    const eye = this.eye();
    const [x, y, z] = this.axes();
    const view = [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
    const f = 1 / Math.tan(0.45), near = this.distance * 0.01 + 0.005, far = this.distance * 50 + 100;
    const projection = [f / Math.max(aspect, 1), 0, 0, 0, 0, f * Math.min(aspect, 1), 0, 0,
                        0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
    return multiply(projection, view);
  }
  rotate(dx, dy) {
    this.yaw -= dx;
    if (this.mode !== 'top') this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + dy));
    this.isFree = true;
  }
  pan(dx, dy, height) {
    const [right, up] = this.axes();
    const reach = this.distance / height;
    this.target = add(this.target, add(scale(right, -dx * reach), scale(up, dy * reach)));
    this.isFree = true;
  }
  zoom(factor) {
    this.distance = Math.min(500, Math.max(0.1, this.distance * factor));
    this.isFree = true;
  }
  /// Moves towards showing a place and a radius around it; true while there is way to go.
  approach(target, radius, share) {
    const distance = radius === null ? this.distance : Math.max(0.5, radius * 2);
    const left = norm(subtract(target, this.target)) + Math.abs(distance - this.distance);
    this.target = mix(this.target, target, share);
    this.distance += (distance - this.distance) * share;
    return left > 1e-3 * this.distance;
  }
}

/// Mouse, fingers and keys on the map; `moved` is called after each change.
function listenToPointers(canvas, view, moved) {
  const fingers = new Map();
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  for (const end of ['pointerup', 'pointercancel'])
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('pointermove', (event) => {
    if (!fingers.has(event.pointerId)) return;
    const before = [...fingers.values()];
    const last = fingers.get(event.pointerId);
    const dx = event.clientX - last[0], dy = event.clientY - last[1];
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size === 2) {
      const after = [...fingers.values()];
      const spread = (p) => Math.hypot(p[0][0] - p[1][0], p[0][1] - p[1][1]);
      view.zoom(Math.max(0.5, Math.min(2, spread(before) / Math.max(1, spread(after)))));
      view.pan(dx / 2, dy / 2, canvas.clientHeight);
    } else if (event.buttons & 6 || event.shiftKey) {
      view.pan(dx, dy, canvas.clientHeight);
    } else {
      view.rotate(dx * 0.006, dy * 0.006);
    }
    moved();
  });
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    view.zoom(Math.exp(Math.max(-0.4, Math.min(0.4, event.deltaY * 0.0015))));
    moved();
  }, {passive: false});
  canvas.addEventListener('keydown', (event) => {
    // Arrows alone step through the run.
    const turns = {
      ArrowLeft: () => view.rotate(0.1, 0), ArrowRight: () => view.rotate(-0.1, 0),
      ArrowUp: () => view.rotate(0, 0.1), ArrowDown: () => view.rotate(0, -0.1),
    };
    const zooms = {'+': () => view.zoom(0.85), '-': () => view.zoom(1.18), '0': () => { view.isFree = false; }};
    const actions = event.shiftKey ? {...turns, ...zooms} : zooms;
    if (!actions[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    actions[event.key]();
    moved();
  });
}
