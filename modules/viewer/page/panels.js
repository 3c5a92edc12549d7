// What stands beside the map: picture, times, errors, state, lists.

const byId = (id) => document.getElementById(id);
const fixed = (value, decimals) => (Number.isFinite(value) ? value.toFixed(decimals).replace('-', '−') : '–');
const grouped = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, '\u202f');
/// The same text again would be laid out again.
function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
/// An element with children; texts become text nodes, so nothing in a name is ever markup.
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (name === 'colour') made.style.background = value;
    else if (value === true) made.setAttribute(name, '');
    else if (value !== false && value !== null) made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}
const cssText = (name, alpha = 1) => {
  const [r, g, b] = cssColour(name).map((x) => Math.round(255 * x));
  return `rgba(${r}, ${g}, ${b}, ${alpha})`;
};
const toText = ([r, g, b]) => `rgb(${Math.round(255 * r)}, ${Math.round(255 * g)}, ${Math.round(255 * b)})`;

/// Where a canvas is drawn. Without a graphics card its imitation takes ten times as long for lines and circles as the
/// browser's own drawing, which a browser uses when it is told that pixels will be read.
const contextOf = (canvas) => canvas.getContext('2d', {willReadFrequently: renderer.isSoft});

/// A new size is new memory, also where it is the old one.
function resize(canvas, width, height) {
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
}

/// A canvas of the size that it has on the screen, in its pixels: [context, width, height], or nothing if it is hidden.
function prepared(canvas) {
  const ratio = Math.min(2, devicePixelRatio || 1), width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width || !height) return null;
  resize(canvas, Math.round(width * ratio), Math.round(height * ratio));
  const context = contextOf(canvas);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return [context, width, height];
}

/// Text that stays readable over lines.
function label(context, text, x, y) {
  context.font = '11px system-ui, sans-serif';
  context.lineWidth = 3;
  context.strokeStyle = cssText('--raised');
  context.strokeText(text, x, y);
  context.fillStyle = cssText('--text');
  context.fillText(text, x, y);
}

function showState(model, connected) {
  const {state} = model;
  const status = state.status_number;
  let text = status === undefined ? 'no frame yet' : statusNames[status], kind = status === undefined ? '' : statusKinds[status];
  if (status === 3 && state.trouble && state.trouble !== 'none') text += `: ${state.trouble.replaceAll('_', ' ')}`;
  if (status === 4) text = state.method === 'relocalised' ? 'relocalised' : 'found again';
  if (state.health === 'degraded') { text = `degraded: ${state.reasons.join(', ')}`; kind = 'warn'; }
  if (state.finished) { text = 'finished'; kind = ''; }
  if (state.paused) text += ', paused';
  // A result that is here does not need the program any more.
  if (connected === false) {
    text = state.finished ? 'finished, offline' : 'connection lost';
    kind = state.finished ? '' : 'bad';
  }
  byId('state').title = connected === false ? 'The program has ended, or was started again and shows a new address. What was received stays here.' : '';
  setText(byId('state'), text);
  byId('state').className = `state ${kind}`;
  const counts = [['frame', state.frame], ['keyframes', state.keyframes], ['points', state.points],
                  ['inliers', state.finished ? undefined : state.inliers], ['loops', model.loops.length / 2]];
  for (const [name, value] of counts) {
    let entry = [...byId('counts').children].find((child) => child.firstChild.textContent === name);
    if (!entry) byId('counts').append(entry = element('div', {}, element('dt', {}, name), element('dd')));
    entry.hidden = value === undefined;
    if (value !== undefined) setText(entry.lastChild, grouped(value));
  }
}

/// Draws the picture with its mask and features; a newer one that comes meanwhile wins.
class PicturePanel {
  constructor() {
    this.canvas = byId('picture');
    this.switches = ['show-mask', 'show-features'].map(byId);
    for (const one of this.switches) one.addEventListener('change', () => this.draw());
  }
  async show(picture, head) {
    this.wanted = picture;
    const image = await createImageBitmap(picture.jpeg);
    if (this.wanted !== picture) return image.close();
    if (this.image) this.image.close();
    Object.assign(this, {image, picture, head});
    byId('picture-name').textContent = `frame ${picture.frame}`;
    this.draw();
  }
  draw() {
    if (!this.image) return;
    const {canvas, image, picture} = this;
    resize(canvas, image.width, image.height);
    const context = contextOf(canvas);
    context.drawImage(image, 0, 0);
    const factor = image.width / this.head.camera[0];
    if (this.switches[0].checked && picture.mask.length) this.drawMask(context, factor);
    if (this.switches[1].checked) this.drawFeatures(context, factor);
  }
  drawMask(context, factor) {
    const {mask, mask_columns: columns} = this.picture, rows = mask.length / columns;
    const cells = new ImageData(columns, rows);
    const tints = [null, ...classTints, [0, 0, 0]];
    for (let i = 0; i < mask.length; ++i) {
      const kind = mask[i] & 7, moving = mask[i] >> 4;
      let [r, g, b] = tints[kind] ?? [255, 0, 0], alpha = kind === 7 ? 70 : kind ? 115 : 0;
      if (moving) {
        const share = kind ? 0.5 : 1;
        [r, g, b] = [r + (255 - r) * share, g * (1 - share), b * (1 - share)];
        alpha = Math.max(alpha, 50 + 6 * moving);
      }
      cells.data.set([r, g, b, alpha], 4 * i);
    }
    const small = new OffscreenCanvas(columns, rows);
    contextOf(small).putImageData(cells, 0, 0);
    context.drawImage(small, 0, 0, columns * 8 * factor, rows * 8 * factor);
  }
  drawFeatures(context, factor) {
    const {places, kinds} = this.picture;
    context.lineWidth = 1.2;
    for (let i = 0; i < kinds.length; ++i) {
      const share = (kinds[i] & 127) / 127, hasPoint = kinds[i] >> 7;
      const colour = `rgb(${Math.round(255 * Math.min(1, 2 - 2 * share))}, ${Math.round(235 * Math.min(1, 2 * share))}, 40)`;
      context.beginPath();
      context.arc(places[2 * i] / 16 * factor, places[2 * i + 1] / 16 * factor, hasPoint ? 2 : 2.4, 0, 7);
      if (hasPoint) { context.fillStyle = colour; context.fill(); }
      else { context.strokeStyle = colour; context.stroke(); }
    }
  }
}

/// Stages of the last frames as stacked bars: the costliest have a colour each, the others one in common.
class TimesPanel {
  show(model) {
    const frames = model.frames.slice(-240);
    const totals = new Map();
    for (const [, , , stages] of frames)
      for (let i = 0; i < stages.length; i += 2) totals.set(stages[i], (totals.get(stages[i]) ?? 0) + stages[i + 1]);
    const order = [...totals].sort((a, b) => b[1] - a[1]).map(([stage]) => stage);
    const named = order.slice(0, 6);
    const colours = named.map((_, i) => cssText(`--series-${i}`));
    const other = cssText('--muted', 0.55);
    const sums = frames.map(([, , , stages]) => {
      const parts = new Array(named.length + 1).fill(0);
      for (let i = 0; i < stages.length; i += 2) {
        const place = named.indexOf(stages[i]);
        parts[place < 0 ? named.length : place] += stages[i + 1];
      }
      return parts;
    });
    const sorted = sums.map((parts) => parts.reduce((a, b) => a + b, 0)).sort((a, b) => a - b);
    const most = Math.max(1, (sorted[Math.floor(sorted.length * 0.95)] ?? 1) * 1.35);
    this.draw(sums, most, [...colours, other]);
    const mean = (total) => `${fixed(total / Math.max(1, frames.length), 2)} ms`;
    const rows = named.map((stage, i) => [model.stages[stage] ?? '?', colours[i], totals.get(stage)]);
    const rest = order.slice(6).reduce((sum, stage) => sum + totals.get(stage), 0);
    if (rest > 0) rows.push(['other', other, rest]);
    byId('stages').replaceChildren(...rows.map(([name, colour, total]) => element('li', {},
        element('i', {colour}), element('span', {title: name}, name), element('b', {}, mean(total)))));
    byId('times-now').textContent = `mean of ${frames.length} frames`;
  }
  draw(sums, most, colours) {
    const ready = prepared(byId('times'));
    if (!ready) return;
    const [context, width, height] = ready;
    const step = width / 240;
    sums.forEach((parts, i) => {
      let y = height;
      const x = width - (sums.length - i) * step;
      parts.forEach((part, k) => {
        const tall = part / most * height;
        context.fillStyle = colours[k];
        context.fillRect(x, y - tall, Math.max(1, step - 0.3), tall);
        y -= tall;
      });
    });
    for (const line of [5, 10, 20, 33.3, 50, 100, 200, 500, 1000].filter((ms) => ms < most * 0.97 && ms > most * 0.12).slice(-3)) {
      const y = height - line / most * height;
      context.fillStyle = cssText('--muted', 0.45);
      context.fillRect(0, y, width, 1);
      label(context, `${line} ms`, 4, y > 14 ? y - 3 : y + 11);
    }
  }
}

/// The state of tracking from the first to the last frame, by colour.
function drawStrip(model) {
  const ready = prepared(byId('strip'));
  if (!ready || !model.history.count) return;
  const [context, width, height] = ready;
  const rows = model.history;
  const colours = {bad: cssText('--moving'), warn: cssText('--doubtful'), good: cssText('--static')};
  for (let x = 0; x < width; ++x) {
    const begin = Math.floor(x / width * rows.count), end = Math.max(begin + 1, Math.floor((x + 1) / width * rows.count));
    let worst = 'good';
    for (let i = begin; i < end; ++i) {
      const kind = statusKinds[rows.data[2 * i + 1]];
      if (kind === 'bad' || (kind === 'warn' && worst === 'good')) worst = kind;
    }
    context.fillStyle = colours[worst];
    context.fillRect(x, 0, 1, height);
  }
}

/// The largest error that colours tell apart: a few worse poses do not take the scale with them.
function errorScale(model) {
  const errors = [];
  for (let i = 0; i < model.path.count; ++i)
    if (Number.isFinite(model.path.row(i)[8])) errors.push(model.path.row(i)[8]);
  errors.sort((a, b) => a - b);
  return errors.length ? Math.max(1e-4, errors[Math.floor(errors.length * 0.97)]) : null;
}

function drawErrors(model, most, now) {
  const ready = prepared(byId('errors'));
  if (!ready || model.path.count < 2) return;
  const [context, width, height] = ready;
  const first = model.stamps.data[0], span = model.stamps.data[model.stamps.count - 1] - first || 1;
  const x = (i) => (model.stamps.data[i] - first) / span * (width - 2) + 1;
  const y = (error) => height - 4 - Math.min(1.15, error / most) * (height - 22) / 1.15;
  for (const share of [0.5, 1]) {
    context.fillStyle = cssText('--muted', 0.35);
    context.fillRect(0, y(share * most), width, 1);
  }
  context.lineWidth = 1.6;
  for (let i = 1; i < model.path.count; ++i) {
    const a = model.path.row(i - 1)[8], b = model.path.row(i)[8];
    if (!Number.isFinite(a + b) || isGap(model, i)) continue;
    context.strokeStyle = toText(rampColour(Math.min(1, b / most)));
    context.beginPath();
    context.moveTo(x(i - 1), y(a));
    context.lineTo(x(i), y(b));
    context.stroke();
  }
  for (const share of [0.5, 1]) label(context, `${fixed(share * most * 1e3, 1)} mm`, 4, y(share * most) - 3);
  if (now !== null) {
    context.fillStyle = cssText('--text');
    context.fillRect(x(now), 0, 1, height);
    const error = model.path.row(now)[8];
    byId('error-now').textContent = Number.isFinite(error) ? `here ${fixed(error * 1e3, 1)} mm` : 'no truth here';
  }
}

/// Whether frames without a pose lie before pose number `i`.
function isGap(model, i) {
  return model.stamps.data[i] - model.stamps.data[i - 1] > 5.5 / (model.head.frame_rate || 30);
}

function showObjects(model) {
  byId('objects-panel').hidden = model.objects.length === 0;
  byId('objects').replaceChildren(...model.objects.map((object) => element('li', {},
      element('i', {colour: toText(objectColour(object.id))}), element('span', {title: object.class || null}, `${object.id} ${object.class || 'object'}`),
      element('b', {}, object.hidden ? 'hidden' : object.moving ? `${fixed(object.speed, 2)} m/s` : 'at rest'))));
}

function showRun(model) {
  byId('figures-panel').hidden = !model.run || model.run.figures.length === 0;
  byId('figures').replaceChildren(...(model.run?.figures ?? []).map(([name, value]) =>
      element('tr', {}, element('th', {scope: 'row'}, name), element('td', {}, value))));
}
function showPanels(model) {
  byId('error-panel').hidden = !model.run?.has_errors;
  byId('picture-panel').hidden = !model.picture;
  byId('times-panel').hidden = model.frames.length === 0;
}
