// Puts the page together: what has changed is drawn again, once a picture of the screen.

let model = new Model();
let connected = null;
let now = null;      // number of a pose of a run that has ended, null = the last
let playing = false;
let errorMost = null;
let fitted = null;   // middle and radius of the map
let moved = true;    // the map has to be drawn again
let loopFlash = 0;   // until when a loop that was just closed is shown

const view = new PointOfView();
const renderer = makeRenderer(byId('map'));
const canvas = renderer.canvas;
const pace = new Pace(renderer.isSoft);
const picturePanel = new PicturePanel(), timesPanel = new TimesPanel();
const shown = {};
const layers = {points: 'map points', cloud: 'dense cloud', mesh: 'surface', seen: 'points in view', moving: 'moving features', path: 'path', truth: 'true path',
                keyframes: 'keyframes', covisibility: 'covisibility', loops: 'loops', objects: 'objects and trails', grid: 'grid'};

const layerOf = (name) => byId('layers').querySelector(`[data-layer=${name}]`);
for (const [name, label] of Object.entries(layers)) {
  shown[name] = true;
  byId('layers').append(element('label', {'data-layer': name}, element('input', {
    type: 'checkbox', checked: true, onchange: (event) => { shown[name] = event.target.checked; moved = true; },
  }), label));
}
layerOf('cloud').hidden = layerOf('mesh').hidden = true;  // until there is one
/// Cuts the mesh where the slider says, from its lowest to its highest place.
function cutMesh() {
  const share = Number(byId('cut').value), [low, high] = model.mesh.heights(view.up);
  renderer.cut = share >= 1 ? Infinity : low + share * (high - low);
  moved = true;
}
byId('cut').addEventListener('input', cutMesh);
const colourings = {state: 'State', class: 'Class'};
for (const [key, label] of Object.entries(colourings))
  byId('colourings').append(element('label', {title: key === 'state' ? 'colour points by whether they stand still' : 'colour points and surface by their class'},
      element('input', {
        type: 'radio', name: 'colouring', value: key, checked: key === 'state',
        onchange: () => { renderer.byClass = key === 'class'; moved = true; showLegend(); },
      }), element('span', {}, label)));
for (const [key, label] of Object.entries({orbit: 'Orbit', follow: 'Follow', top: 'Top'}))
  byId('views').append(element('label', {}, element('input', {
    type: 'radio', name: 'view', value: key, checked: key === 'orbit',
    onchange: () => { view.mode = key; view.isFree = false; moved = true; },
  }), element('span', {}, label)));
byId('whole').addEventListener('click', () => { view.isFree = false; moved = true; });
listenToPointers(canvas, view, () => { moved = true; });
canvas.addEventListener('webglcontextlost', () => location.reload());

const connection = new Connection((message, isFirst) => {
  if (isFirst) {
    model = new Model();  // the program tells everything again
    now = null;
    loopFlash = 0;
  }
  const loops = model.closedLoops;
  model.apply(message);
  if (!isFirst && model.closedLoops > loops) loopFlash = performance.now() + 4000;
}, (isConnected) => {
  connected = isConnected;
  pace.rate = 30;  // of a new connection
  model.changed.add('state');
  askForRate();
});
for (const kind of ['pointerdown', 'wheel', 'keydown', 'input', 'change'])
  document.addEventListener(kind, () => pace.touch(), {capture: true, passive: true});
document.addEventListener('pointermove', (event) => { if (event.buttons) pace.touch(); }, {capture: true, passive: true});
document.addEventListener('themechange', () => pace.touch());
document.addEventListener('visibilitychange', () => { askForRate(); pace.touch(); });
/// Has the program send as many messages as can be shown.
function askForRate() {
  if (!connected) return;
  const rate = pace.messageRate();
  if (rate === pace.rate) return;
  pace.rate = rate;
  connection.send(`rate ${rate}`);
}

// Playing: a run in progress by the program, one that has ended here.
function showControls() {
  const finished = Boolean(model.state.finished);
  byId('pause').textContent = finished ? (playing ? 'Pause' : 'Play') : model.state.paused ? 'Resume' : 'Pause';
  byId('step').disabled = finished ? false : !model.state.paused;
  byId('pause').disabled = byId('speed').disabled = connected === false && !finished;
  byId('slider').hidden = !finished || model.path.count < 2;
  byId('strip').hidden = model.history.count === 0;
  byId('slider').max = Math.max(0, model.path.count - 1);
  byId('slider').value = now ?? byId('slider').max;
  if (!finished && document.activeElement !== byId('speed') && model.state.speed !== undefined) byId('speed').value = String(model.state.speed);
  if (finished && byId('speed').value === '0') byId('speed').value = '1';
}
function seek(i) {
  now = Math.max(0, Math.min(model.path.count - 1, Math.round(i)));
  byId('slider').value = now;
  model.changed.add('now');
}
byId('pause').addEventListener('click', () => {
  if (!model.state.finished) return connection.send(model.state.paused ? 'resume' : 'pause');
  playing = !playing;
  if (playing && (now === null || now >= model.path.count - 1)) seek(0);
  model.changed.add('state');
});
byId('step').addEventListener('click', () => {
  step(1);
});
byId('speed').addEventListener('change', (event) => {
  if (!model.state.finished) connection.send(`speed ${event.target.value}`);
});
byId('slider').addEventListener('input', (event) => { playing = false; seek(Number(event.target.value)); model.changed.add('state'); });
byId('errors').addEventListener('pointerdown', (event) => {
  const first = model.stamps.data[0], span = model.stamps.data[model.stamps.count - 1] - first;
  const stamp = first + event.offsetX / byId('errors').clientWidth * span;
  let i = 0;
  while (i < model.path.count - 1 && model.stamps.data[i] < stamp) ++i;
  seek(i);
});
/// One frame on or back. A run in progress knows no way back; it pauses first.
function step(by) {
  if (model.state.finished) {
    playing = false;
    seek((now ?? model.path.count - 1) + by);
    model.changed.add('state');
  } else if (by > 0) {
    connection.send('step');
  }
}
document.addEventListener('keydown', (event) => {
  if (['INPUT', 'SELECT', 'BUTTON', 'SUMMARY'].includes(document.activeElement?.tagName)) return;
  if (event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
  const actions = {' ': () => byId('pause').click(), '.': () => step(1), ArrowRight: () => step(1), ArrowLeft: () => step(-1)};
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
});
// What was clicked keeps no keys for itself: the next space pauses. The keyboard's own way to a control is as ever.
document.addEventListener('click', (event) => {
  if (event.detail === 0) return;  // of the keyboard
  const release = () => {
    if (document.activeElement?.matches('button, summary, input[type=radio], input[type=checkbox]')) document.activeElement.blur();
  };
  release();
  setTimeout(release);  // a label gives its control the focus after this
});

let lastTick = null;
function play(time) {
  const seconds = lastTick === null ? 0 : (time - lastTick) / 1000;
  lastTick = time;
  if (!playing || !model.state.finished || now === null) { play.stamp = null; return; }
  play.stamp = (play.stamp ?? model.stamps.data[now]) + Math.min(0.2, seconds) * (Number(byId('speed').value) || 1);
  let i = now;
  while (i < model.path.count - 1 && model.stamps.data[i + 1] <= play.stamp) ++i;
  if (i < model.path.count - 1 && model.stamps.data[i + 1] - model.stamps.data[i] > 2) play.stamp = model.stamps.data[++i];
  if (i !== now) seek(i);
  if (i === model.path.count - 1) { playing = false; model.changed.add('state'); }
}

/// Middle and radius of what matters of the map, outliers aside, and which way is up.
function fit() {
  const places = [];
  const count = model.points.count, stride = Math.max(1, Math.floor(count / 3000));
  for (let i = 0; i < count; i += stride) {
    const [x, y, z, evidence] = model.points.row(i);
    if (evidence === evidence) places.push([x, y, z]);
  }
  const steps = Math.max(1, Math.floor(model.path.count / 500));
  const path = [];
  for (let i = 0; i < model.path.count; i += steps) path.push([...model.path.row(i).subarray(0, 3)]);
  if (places.length + path.length < 2) return null;
  const all = places.concat(path);
  const low = [], high = [];
  for (let axis = 0; axis < 3; ++axis) {
    const sorted = all.map((place) => place[axis]).sort((a, b) => a - b);
    low.push(sorted[Math.floor(sorted.length * 0.04)]);
    high.push(sorted[Math.min(sorted.length - 1, Math.floor(sorted.length * 0.96))]);
  }
  let up = [0, 0, 0];
  for (const {pose} of model.keyframes.values()) up = add(up, turn(pose, [0, -1, 0]));
  if (norm(up) > 0.5 * model.keyframes.size && model.keyframes.size) view.up = unit(up);
  return {middle: scale(add(low, high), 0.5), radius: Math.max(0.3, 0.5 * norm(subtract(high, low))), low, high, places};
}

function buildGrid() {
  const lines = new Lines();
  if (fitted) {
    const up = view.up, [a, b] = view.basis();
    // Below nearly all points.
    const heights = fitted.places.map((place) => dot(place, up)).sort((x, y) => x - y);
    const floor = heights.length ? heights[Math.floor(heights.length * 0.01)] : dot(fitted.middle, up);
    const step = fitted.radius > 40 ? 10 : fitted.radius > 8 ? 2 : fitted.radius > 2 ? 1 : 0.25;
    const origin = add(fitted.middle, scale(up, floor - dot(fitted.middle, up)));
    const reach = Math.ceil(fitted.radius * 1.3 / step) * step;
    for (let at = -reach; at <= reach + 1e-9; at += step) {
      const colour = cssColour('--muted', 0.16);
      lines.add(add(origin, add(scale(a, at), scale(b, -reach))), add(origin, add(scale(a, at), scale(b, reach))), colour);
      lines.add(add(origin, add(scale(b, at), scale(a, -reach))), add(origin, add(scale(b, at), scale(a, reach))), colour);
    }
  }
  renderer.setLines('grid', lines, 1);
}

function buildPath() {
  const lines = new Lines(), truth = new Lines();
  errorMost = model.run?.has_errors ? errorScale(model) : null;
  const plain = cssColour('--accent'), again = cssColour('--doubtful');
  for (let i = 1; i < model.path.count; ++i) {
    if (isGap(model, i)) continue;
    const row = model.path.row(i);
    const colour = errorMost === null ? (row[7] === 4 ? again : plain)
        : Number.isFinite(row[8]) ? rampColour(Math.min(1, row[8] / errorMost)) : cssColour('--muted');
    lines.add(model.path.row(i - 1), row, colour);
  }
  if (model.truth)
    for (let i = 1; i < model.truth.stamps.length; ++i)
      truth.add(model.truth.places.subarray(3 * i - 3, 3 * i), model.truth.places.subarray(3 * i, 3 * i + 3), cssColour('--text', 0.55));
  renderer.setLines('path', lines, 2.6);
  renderer.setLines('truth', truth, 1.4);
}

function buildKeyframes() {
  const frusta = new Lines(), edges = new Lines(), loops = new Lines();
  const size = Math.min(0.3, Math.max(0.05, (fitted?.radius ?? 2) * 0.02));
  for (const {pose} of model.keyframes.values()) frusta.addFrustum(pose, model.head.camera, size, cssColour('--series-0', 0.6));
  const connect = (pairs, lines, colour) => {
    for (let i = 0; i < pairs.length; i += 2) {
      const a = model.keyframes.get(pairs[i]), b = model.keyframes.get(pairs[i + 1]);
      if (a && b) lines.add(a.pose, b.pose, colour);
    }
  };
  connect(model.covisibility, edges, cssColour('--series-2', model.state.finished ? 0.14 : 0.28));
  connect(model.loops, loops, cssColour('--loop'));
  renderer.setLines('keyframes', frusta, 1.1);
  renderer.setLines('covisibility', edges, 1);
  renderer.setLines('loops', loops, performance.now() < loopFlash ? 5 : 2.4);
}

function buildObjects() {
  const lines = new Lines();
  for (const [id, places] of model.trails)
    for (let i = 1; i < places.count; ++i)
      if (norm(subtract(places.row(i), places.row(i - 1))) < 0.7) lines.add(places.row(i - 1), places.row(i), objectColour(id, 0.8));
  if (!model.state.finished)
    for (const object of model.objects)
      lines.addBox(object.pose, object.box.slice(0, 3), object.box.slice(3), objectColour(object.id, object.hidden ? 0.35 : 1));
  renderer.setLines('objects', lines, 1.8);
}

function buildCamera() {
  const lines = new Lines();
  const pose = model.pose(now);
  if (pose) lines.addFrustum(pose, model.head.camera, Math.min(1.5, Math.max(0.15, (fitted?.radius ?? 2) * 0.1)), cssColour(model.state.status_number === 3 ? '--moving' : '--text'));
  renderer.setLines('camera', lines, 2.2);
}

/// Names and colours of the classes that points have.
function namedClasses() {
  const colours = classColours();
  const names = model.head.classes.map((name, label) => [name, toText(colours[classPlace(label)])]).filter((_, label) => model.seenClasses.has(label));
  if (model.seenClasses.has(unknownClass)) names.push(['class unknown', 'var(--unmeasured)']);
  return names;
}
let shownLegend = '';
function showLegend() {
  const hasClasses = (model.head.classes?.length ?? 0) > 0;
  byId('colourings').hidden = !hasClasses;
  const byClass = renderer.byClass && hasClasses;
  const kinds = byClass ? namedClasses()
      : [['static', '--static'], ['doubtful', '--doubtful'], ['moving', '--moving'], ['not measured', '--unmeasured'],
         ...(model.state.finished ? [] : [['in view', '--accent']])].map(([name, colour]) => [name, `var(${colour})`]);
  const legend = JSON.stringify([kinds, errorMost, Boolean(model.truth), model.loops.length > 0]);
  if (legend === shownLegend) return;
  shownLegend = legend;
  const entries = kinds.map(([name, colour]) => element('li', {}, element('i', {colour}), name));
  if (errorMost !== null)
    entries.push(element('li', {}, element('i', {class: 'line', colour: 'linear-gradient(90deg, var(--static), var(--doubtful), var(--moving))'}), `path by error, to ${fixed(errorMost * 1e3, 1)} mm`));
  else entries.push(element('li', {}, element('i', {class: 'line', colour: 'var(--accent)'}), 'path'));
  if (model.truth) entries.push(element('li', {}, element('i', {class: 'line', colour: 'var(--text)'}), 'true path'));
  if (model.loops.length) entries.push(element('li', {}, element('i', {class: 'line', colour: 'var(--loop)'}), 'loop'));
  byId('legend').replaceChildren(...entries);
}

function showClock() {
  const stamp = model.state.finished && now !== null ? model.stamps.data[now] : model.state.timestamp ?? model.stamps.data[Math.max(0, model.stamps.count - 1)];
  const first = model.history.count ? model.history.data[0] : model.stamps.data[0];
  byId('clock').textContent = Number.isFinite(stamp - first) ? `${fixed(stamp - first, 2)} s` : '';
}

let nextFit = 0, nextTimes = 0, nextObjects = 0, lastAim = 0;
let fitWaits = null, framesWait = false, objectsWait = false;  // for their next turn: what is drawn seldom is not left out at the end
const frameTimes = [];
/// Asks for the next turn: with the next picture of the screen, or, when nothing has changed for a while, when something
/// does. A browser without a graphics card works for every picture that it is asked for, even if nothing is drawn.
let quietTurns = 0;
function awaitTurn() {
  askForRate();
  const wait = (milliseconds, then) => {
    let timer = null;
    const go = () => {
      clearTimeout(timer);
      pace.wake = () => {};
      then();
    };
    pace.wake = go;
    timer = setTimeout(go, Math.max(0, milliseconds));
  };
  // In a run that goes on; one that has ended needs no processor.
  if (pace.isCalm() && !model.state.finished && !playing)
    return wait(pace.last + pace.pause() - performance.now(), () => requestAnimationFrame(refresh));
  const isAsked = quietTurns < 30 || model.changed.size > 0 || moved || playing || framesWait || objectsWait || loopFlash > 0 || detail.isReduced;
  if (isAsked) requestAnimationFrame(refresh);
  else wait(pace.isCalm() ? 200 : 40, awaitTurn);
}
/// Takes over what has changed since the last picture of the screen, and draws it.
function refresh(time) {
  pace.last = performance.now();
  update(time);
  if (pace.isDear && frameTimes.at(-1) === time) {
    renderer.finish();
    pace.drew(performance.now() - pace.last);
  }
  awaitTurn();
}
function update(time) {
  play(time);
  const changed = model.changed;
  const has = (...names) => changed.has('all') || names.some((name) => changed.has(name));
  if (has('points')) {
    const range = model.changedPoints ?? null;
    renderer.setPoints(renderer.pointBuffer, model.points.data, model.points.count, changed.has('all') ? null : range);
    model.changedPoints = null;
  }
  if (has('picture', 'run') && model.picture) {
    renderer.setSeen(model.state.finished ? new Uint32Array() : model.seen.filter((slot) => slot < model.points.count));
    const count = model.movingFeatures.length / 3, rows = new Float32Array(pointWidth * count);
    for (let i = 0; i < count; ++i) rows.set(model.movingFeatures.subarray(3 * i, 3 * i + 3), pointWidth * i);
    renderer.setPoints(renderer.movingBuffer, rows, model.state.finished ? 0 : count);
  }
  if (has('cloud')) {
    renderer.setPoints(renderer.cloudBuffer, model.cloud.data, model.cloud.count, changed.has('all') ? null : model.changedCloud ?? null);
    model.changedCloud = null;
    layerOf('cloud').hidden = model.cloud.count === 0;
  }
  if (has('mesh')) showMesh();
  if (has('points', 'path', 'keyframes') && time > nextFit) {
    fitted = fit() ?? fitted;
    buildGrid();
    nextFit = time + (pace.isCalm() ? 2000 : 700);
  } else if (has('points', 'path') && time <= nextFit) {
    fitWaits ??= setTimeout(() => { fitWaits = null; model.changed.add('keyframes'); }, nextFit - time + 50);
  }
  if (has('path', 'run', 'head')) buildPath();
  if (has('keyframes', 'loop', 'head', 'run')) buildKeyframes();
  if (loopFlash && performance.now() > loopFlash) { loopFlash = 0; buildKeyframes(); moved = true; }
  objectsWait ||= has('objects', 'state');
  if (objectsWait && time > nextObjects) { buildObjects(); nextObjects = time + 60; objectsWait = false; moved = true; }
  if (has('state', 'path', 'now', 'head')) buildCamera();
  if (has('head')) {
    byId('title').textContent = model.head.title || 'Holdfast';
    document.title = `${model.head.title || 'run'} – Holdfast`;
  }
  // Panels are shown before they are drawn: what is hidden has no size.
  if (has('run')) showRun(model);
  if (has('run', 'picture', 'frames')) showPanels(model);
  if (has('state', 'keyframes', 'path', 'run', 'frames')) showControls();
  if (has('picture') && model.picture) picturePanel.show(model.picture, model.head);
  framesWait ||= has('frames');
  if (framesWait && time > nextTimes) {
    framesWait = false;
    timesPanel.show(model);
    drawStrip(model);
    nextTimes = time + pace.panelPause();
  }
  if (has('state', 'keyframes', 'path', 'run')) showState(model, connected);
  if (has('objects')) showObjects(model);
  if (has('run', 'path', 'keyframes', 'state', 'head', 'points', 'mesh')) showLegend();
  if (has('run', 'path', 'now') && errorMost !== null) drawErrors(model, errorMost, now);
  if (has('state', 'now', 'run')) showClock();
  const isBusy = changed.size > 0;
  changed.clear();

  // A fifth of the way with each picture at sixty per second, and more where there are fewer.
  const share = 1 - 0.8 ** Math.min(10, Math.max(1, (time - lastAim) / 17));
  lastAim = time;
  let aims = false;
  if (view.mode === 'follow' && model.pose(now)) aims = view.approach([...model.pose(now).slice(0, 3)], view.isFree ? null : Math.min(1.6, fitted?.radius ?? 1.6), share);
  else if (!view.isFree && fitted) aims = view.approach(fitted.middle, fitted.radius, share);
  quietTurns = isBusy || moved || aims ? 0 : quietTurns + 1;
  if (isBusy || moved || aims) {
    chooseDetail(time);
    renderer.draw(view, shown, detail.step);
    moved = false;
    frameTimes.push(time);
    if (frameTimes.length > 60) frameTimes.shift();
  } else if (detail.isReduced && time > detail.last + 250) {
    renderer.draw(view, shown);
    detail.isReduced = false;
  } else {
    detail.isMoving = false;
  }
}

/// Hands the groups of the mesh that have changed to the renderer.
function showMesh() {
  const {mesh} = model, groups = mesh.changedGroups;
  if (groups.has('all')) renderer.clearMesh();
  for (let i = 0; i < mesh.groupCount(); ++i)
    if (groups.has('all') || groups.has(i)) renderer.setGroup(i, mesh.group(i));
  groups.clear();
  renderer.meshHasClasses = mesh.hasClasses;
  byId('cutting').hidden = layerOf('mesh').hidden = mesh.triangles === 0;
  cutMesh();
}

/// A machine that cannot draw the whole map 25 times a second draws a part of the points while something moves, and all
/// of them when it rests.
const detail = {step: 1, last: 0, mean: 20, isReduced: false, isMoving: false};
function chooseDetail(time) {
  // Only times between pictures that follow each other tell how long drawing takes.
  if (detail.isMoving) detail.mean += 0.3 * (Math.min(300, time - detail.last) - detail.mean);
  detail.last = time;
  detail.isMoving = true;
  const before = detail.step;
  if (detail.mean > 42 && (model.points.count + model.cloud.count) / detail.step > 4000)
    detail.step = Math.min(8, 2 * detail.step);  // WebGL knows no rows of more than 255 bytes
  else if (detail.mean < 22) detail.step = Math.max(1, detail.step / 2);
  if (detail.step !== before) detail.mean = 32;  // see what it is worth first
  detail.isReduced = detail.step > 1;
}

const redraw = () => { colourCache.clear(); model.changed.add('all'); picturePanel.draw(); };
document.addEventListener('themechange', redraw);
new ResizeObserver(() => { moved = true; model.changed.add('frames'); model.changed.add('run'); model.changed.add('now'); }).observe(document.body);
// For tests, and for whoever wants to know: what is drawn, and how fast.
globalThis.holdfastViewer = {
  counts: () => ({points: model.points.count, cloud: model.cloud.count, triangles: model.mesh.triangles, path: model.path.count, keyframes: model.keyframes.size, loops: model.loops.length / 2,
                  connected, state: model.state, truth: model.truth?.stamps.length ?? 0, picture: model.picture?.frame ?? null}),
  point: (i) => [...model.points.row(i).subarray(0, 3)],
  classOf: (i) => model.points.row(i)[4],
  cloudPoint: (i) => [...model.cloud.row(i)],
  cutAt: (height) => { renderer.cut = height; moved = true; },
  place: (i) => [...model.path.row(i).subarray(0, 3)],
  send: (text) => connection.send(text),
  view,
  draw: () => renderer.draw(view, shown),
  size: () => [canvas.width, canvas.height],
  drawsBySoftware: () => renderer.isSoft,
  pixel: (x, y) => { renderer.draw(view, shown); return renderer.pixel(x, y); },
  objectColour: (id) => objectColour(id),
  framesPerSecond: () => 1000 * (frameTimes.length - 1) / (frameTimes.at(-1) - frameTimes[0]),
  spin: (on) => { clearInterval(view.spinning); frameTimes.length = 0; if (on) view.spinning = setInterval(() => { view.rotate(0.01, 0); moved = true; pace.touch(); }, 10); },
  pace: () => ({calm: pace.isCalm(), pause: pace.pause(), cost: pace.cost, rate: pace.rate}),
};
requestAnimationFrame(refresh);
