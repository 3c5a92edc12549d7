// Trajectories over the truth, on a canvas with one scale for both axes, and errors over time (uPlot), of chosen runs.

const planes = {
  xy: {label: 'z: x–y', axes: ['x', 'y']},
  xz: {label: 'y: x–z', axes: ['x', 'z']},
  yz: {label: 'x: y–z', axes: ['y', 'z']},
};

/// The plane in which a line reaches farthest.
function widestPlane(line) {
  const extent = (axis) => {
    const values = line[axis].filter(isNumber);
    return values.reduce((a, b) => Math.max(a, b), -Infinity) - values.reduce((a, b) => Math.min(a, b), Infinity);
  };
  const narrowest = ['x', 'y', 'z'].sort((a, b) => extent(a) - extent(b))[0];
  return {x: 'yz', y: 'xz', z: 'xy'}[narrowest];
}

/// The place in a rising list that is nearest to a value.
function nearestPlace(list, value) {
  let low = 0, high = list.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low > 0 && value - list[low - 1] < list[low] - value ? low - 1 : low;
}

/// The places of values between breaks, which make no line: they are drawn as dots. A value that is undefined belongs to
/// another line's time, and breaks nothing.
function lonelyPlaces(values) {
  const places = [];
  values.forEach((value, i) => value !== undefined && places.push(i));
  const isThere = (k) => k >= 0 && k < places.length && values[places[k]] !== null;
  return places.filter((_, k) => isThere(k) && !isThere(k - 1) && !isThere(k + 1));
}

/// 1, 2 or 5 times a power of ten, not below a value.
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least);
}

/// Draws lines { line: {t, x, y, z}, colour, dash, width } from a viewpoint that its user moves.
class TrajectoryCanvas {
  constructor(canvas, pointedAt) {
    this.canvas = canvas;
    this.pointedAt = pointedAt;  // called with a time [s], or nothing
    this.lines = [];
    this.axes = ['x', 'y'];
    this.time = null;
    this.pointers = new Map();
    this.fit();
    canvas.addEventListener('wheel', (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015), event.offsetX, event.offsetY);
    }, {passive: false});
    canvas.addEventListener('pointerdown', (event) => {
      canvas.focus({preventScroll: true});
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    });
    canvas.addEventListener('pointermove', (event) => this.pointerMoved(event));
    for (const end of ['pointerup', 'pointercancel'])
      canvas.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
    canvas.addEventListener('pointerleave', () => this.pointers.size === 0 && this.pointedAt(null));
    canvas.addEventListener('keydown', (event) => this.keyPressed(event));
    new ResizeObserver(() => (this.isWhole ? this.fit() : this.draw())).observe(canvas);
  }

  show(lines, axes) {
    this.lines = lines;
    this.axes = axes;
    this.draw();
  }
  /// Marks where every run was at a time.
  mark(time) {
    this.time = time;
    this.draw();
  }
  fit() {
    this.view = null;
    this.isWhole = true;
    this.draw();
  }
  zoom(factor, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2) {
    const {view} = this;
    if (!view) return;
    this.isWhole = false;
    const scale = Math.min(Math.max(view.scale * factor, 1), 1e6);
    view.x += (x - this.canvas.clientWidth / 2) * (1 / view.scale - 1 / scale);
    view.y -= (y - this.canvas.clientHeight / 2) * (1 / view.scale - 1 / scale);
    view.scale = scale;
    this.draw();
  }
  pan(x, y) {
    if (!this.view) return;
    this.isWhole = false;
    this.view.x -= x / this.view.scale;
    this.view.y += y / this.view.scale;
    this.draw();
  }

  keyPressed(event) {
    const step = 40;
    const actions = {
      ArrowLeft: () => this.pan(step, 0), ArrowRight: () => this.pan(-step, 0), ArrowUp: () => this.pan(0, step),
      ArrowDown: () => this.pan(0, -step), '+': () => this.zoom(1.25), '=': () => this.zoom(1.25),
      '-': () => this.zoom(0.8), '0': () => this.fit(),
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    actions[event.key]();
  }

  pointerMoved(event) {
    const now = [event.offsetX, event.offsetY];
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      this.pointAt(...now);
      return;
    }
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const distance = (a) => Math.max(Math.hypot(a[0] - other[0], a[1] - other[1]), 1);
      this.zoom(distance(now) / distance(before), other[0], other[1]);
    } else {
      this.pan(now[0] - before[0], now[1] - before[1]);
    }
    this.pointers.set(event.pointerId, now);
  }

  /// Tells the time of the nearest position, if one is near.
  pointAt(x, y) {
    if (!this.view) return;
    let best = 15 ** 2, time = null;
    for (const {line} of this.lines)
      for (let i = 0; i < line.t.length; ++i) {
        const [px, py] = this.toScreen(line, i);
        const distance = (px - x) ** 2 + (py - y) ** 2;
        if (distance < best) [best, time] = [distance, line.t[i]];
      }
    this.pointedAt(time);
  }

  toScreen(line, i) {
    const a = line[this.axes[0]][i], b = line[this.axes[1]][i];
    if (a === null) return [NaN, NaN];
    const {x, y, scale} = this.view;
    return [this.canvas.clientWidth / 2 + (a - x) * scale, this.canvas.clientHeight / 2 - (b - y) * scale];
  }

  fitView(width, height) {
    let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (const {line} of this.lines)
      this.axes.forEach((axis, k) => line[axis].forEach((value) => {
        if (value === null) return;
        low[k] = Math.min(low[k], value);
        high[k] = Math.max(high[k], value);
      }));
    if (!isNumber(low[0])) [low, high] = [[-1, -1], [1, 1]];
    const reach = [0, 1].map((k) => Math.max(high[k] - low[k], 0.01));
    this.view = {x: (low[0] + high[0]) / 2, y: (low[1] + high[1]) / 2,
                 scale: Math.min((width - 70) / reach[0], (height - 60) / reach[1])};
  }

  draw() {
    const {canvas} = this;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (width === 0 || height === 0) return;
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    if (!this.view) this.fitView(width, height);
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    context.clearRect(0, 0, width, height);
    this.drawGrid(context, width, height);
    context.lineJoin = 'round';
    for (const {line, colour, dash, lineWidth} of this.lines) {
      context.strokeStyle = colour;
      context.lineWidth = lineWidth;
      context.setLineDash(dash);
      context.beginPath();
      let isBroken = true;
      for (let i = 0; i < line.t.length; ++i) {
        const [x, y] = this.toScreen(line, i);
        if (Number.isNaN(x)) isBroken = true;
        else if (isBroken) context.moveTo(x, y), isBroken = false;
        else context.lineTo(x, y);
      }
      context.stroke();
      context.fillStyle = colour;
      for (const i of lonelyPlaces(line[this.axes[0]])) {
        context.beginPath();
        context.arc(...this.toScreen(line, i), 2.5, 0, 2 * Math.PI);
        context.fill();
      }
    }
    if (this.time !== null) this.drawMarks(context);
  }

  drawGrid(context, width, height) {
    const {x, y, scale} = this.view;
    const step = niceStep(70 / scale);
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    context.setLineDash([]);
    context.lineWidth = 1;
    context.strokeStyle = style('--grid');
    context.fillStyle = style('--muted');
    context.font = '11px system-ui, sans-serif';
    context.beginPath();
    for (let i = Math.ceil((x - width / 2 / scale) / step); i * step <= x + width / 2 / scale; ++i) {
      const at = width / 2 + (i * step - x) * scale;
      context.moveTo(at, 0), context.lineTo(at, height);
      if (at > 40 && at < width - 80) context.fillText((i * step).toFixed(decimals), at + 3, height - 5);
    }
    for (let i = Math.ceil((y - height / 2 / scale) / step); i * step <= y + height / 2 / scale; ++i) {
      const at = height / 2 - (i * step - y) * scale;
      context.moveTo(0, at), context.lineTo(width, at);
      if (at > 32 && at < height - 24) context.fillText((i * step).toFixed(decimals), 4, at - 3);
    }
    context.stroke();
    context.fillText(`${this.axes[0]} [m]`, width - 32, height - 5);
    context.fillText(`${this.axes[1]} [m]`, 4, 12);
  }

  drawMarks(context) {
    context.setLineDash([]);
    context.lineWidth = 2;
    context.strokeStyle = style('--surface');
    for (const {line, colour} of this.lines) {
      const i = nearestPlace(line.t, this.time);
      if (!(Math.abs(line.t[i] - this.time) < 0.5)) continue;
      const [x, y] = this.toScreen(line, i);
      if (Number.isNaN(x)) continue;
      context.fillStyle = colour;
      context.beginPath();
      context.arc(x, y, 5, 0, 2 * Math.PI);
      context.fill(), context.stroke();
    }
  }
}

/// Errors over time of runs; made anew when the runs change.
class ErrorPlot {
  constructor(box, pointedAt) {
    this.box = box;
    this.pointedAt = pointedAt;
    this.runs = [];
    new ResizeObserver(() => this.plot?.setSize(this.size())).observe(box);
  }
  size() {
    return {width: Math.max(this.box.clientWidth, 200), height: Math.max(this.box.clientHeight, 200)};
  }
  show(runs, isLogarithmic) {
    this.plot?.destroy();
    this.plot = null;
    if (runs.length === 0) return;
    const curves = runs.map((run) => tracks.runs[placeOfRun.get(run)].error);
    // 2: a break reaches over the times of other runs to its neighbours.
    const data = uPlot.join(curves.map((curve) => [curve.t, isLogarithmic ? curve.e.map((e) => e || null) : curve.e]),
                            curves.map(() => [0, 2]));
    const axis = {stroke: () => style('--muted'), grid: {stroke: () => style('--grid'), width: 1},
                  ticks: {stroke: () => style('--grid'), width: 1}, font: '11px system-ui, sans-serif'};
    this.plot = new uPlot({
      ...this.size(),
      legend: {show: false},
      cursor: {points: {size: 7}},
      scales: {x: {time: false}, y: isLogarithmic ? {distr: 3} : {range: (_, low, high) => [0, high > 0 ? 1.05 * high : 1]}},
      axes: [{...axis, label: undefined, values: (_, values) => values.map((v) => `${+v.toFixed(3)} s`)},
             {...axis, size: 78, values: (_, values) => values.map((v) => (v === null ? null : `${+v.toPrecision(3)} m`))}],
      series: [{}, ...runs.map((run) => ({stroke: () => colourOf(run), dash: dashOf(run), width: 1.5, spanGaps: false,
                                          points: {show: true, size: 5, fill: () => colourOf(run), filter: (plot, i) => lonelyPlaces(plot.data[i])}}))],
      hooks: {setCursor: [(plot) => {
        if (this.isFollowing) return;
        const {idx} = plot.cursor;
        this.pointedAt(idx === null || idx === undefined || plot.cursor.left < 0 ? null : plot.data[0][idx]);
      }]},
    }, data, this.box);
  }
  /// Shows the time that is looked at elsewhere.
  mark(time) {
    if (!this.plot) return;
    this.isFollowing = true;
    const left = time === null ? -10 : this.plot.valToPos(time, 'x');
    this.plot.setCursor({left, top: time === null ? -10 : 10}, false);
    this.isFollowing = false;
  }
}

/// The section: chooses runs of one sequence and shows them in both pictures.
class TrajectorySection {
  constructor(changed) {
    this.changed = changed;
    this.canvas = new TrajectoryCanvas(byId('trajectory-canvas'), (time) => this.pointedAt(time, true));
    this.plot = new ErrorPlot(byId('error-plot'), (time) => this.pointedAt(time, false));
    this.sequences = results.sequences.map((_, s) => s).filter((s) => tracks.truth[s] !== null);
    byId('trajectories').hidden = this.sequences.length === 0;
    byId('sequence').append(...this.sequences.map((s) => element('option', {value: s}, sequenceName(s))));
    byId('sequence').addEventListener('change', () => this.choose(Number(byId('sequence').value)));
    makeChoice('plane', Object.fromEntries(Object.entries(planes).map(([key, plane]) => [key, plane.label])), '', (key) => {
      this.plane = key;
      this.show();
      this.canvas.fit();
    });
    byId('zoom-in').addEventListener('click', () => this.canvas.zoom(1.25));
    byId('zoom-out').addEventListener('click', () => this.canvas.zoom(0.8));
    byId('zoom-fit').addEventListener('click', () => this.canvas.fit());
    byId('logarithmic').addEventListener('change', () => this.show());
  }

  runsOf(sequence) {
    return results.runs.filter((run, i) => run.sequence === sequence && tracks.runs[i] !== null);
  }
  /// Shows a sequence: the runs given by id, or else the first of every variant.
  choose(sequence, ids = null, plane = null) {
    if (!this.sequences.includes(sequence)) return;
    this.sequence = sequence;
    byId('sequence').value = sequence;
    const runs = this.runsOf(sequence);
    this.chosen = new Set(runs.filter((run) => (ids ? ids.includes(run.id) :
                                                runs.find((other) => other.variant === run.variant) === run)));
    this.plane = plane ?? widestPlane(tracks.truth[sequence]);
    document.querySelector(`#plane input[value=${this.plane}]`).checked = true;
    this.listRuns(runs);
    this.show();
    this.canvas.fit();
  }
  listRuns(runs) {
    const many = runs.some((run) => runs.some((other) => other !== run && other.variant === run.variant));
    const sample = (colour, dash, width) => element('svg', {viewBox: '0 0 28 10', class: 'sample', 'aria-hidden': 'true'},
        element('line', {x1: 1, x2: 27, y1: 5, y2: 5, style: `stroke: ${colour}`, 'stroke-width': width, 'stroke-dasharray': dash.join(' ') || null}));
    const failed = results.runs.filter((run) => run.sequence === this.sequence && run.result !== null && !run.tracks);
    fill('chosen-runs', element('legend', {}, 'Runs'),
         element('span', {class: 'truth'}, sample('var(--truth)', [], 4), 'truth'),
         runs.map((run) => element('label', {}, element('input', {
           type: 'checkbox', value: run.id, checked: this.chosen.has(run), onchange: (event) => {
             if (event.target.checked) this.chosen.add(run);
             else this.chosen.delete(run);
             this.show();
           }}), sample(`var(--series-${run.variant % coloursInScale})`, dashOf(run), 2.5),
           variantName(run.variant) + (many ? `, ${chanceOf(run)}` : ''), hasTrouble(run) ? outcomeMarks(run) : null)),
         failed.map((run) => element('span', {class: 'absent'}, variantName(run.variant), outcomeMarks(run))));
  }

  show() {
    const runs = this.runsOf(this.sequence).filter((run) => this.chosen.has(run));
    this.lines = [{line: tracks.truth[this.sequence], colour: style('--truth'), dash: [], lineWidth: 4, name: 'truth'}];
    for (const run of runs) {
      const {track, error} = tracks.runs[results.runs.indexOf(run)];
      this.lines.push({line: track, error, colour: colourOf(run), dash: dashOf(run), lineWidth: 1.75,
                       name: `${variantName(run.variant)} (${chanceOf(run)})`});
    }
    this.canvas.show(this.lines, planes[this.plane].axes);
    byId('trajectory-canvas').setAttribute('aria-label', `Trajectories on ${sequenceName(this.sequence)}: ${this.lines.map((line) => line.name).join(', ')}`);
    this.plot.show(runs, byId('logarithmic').checked);
    this.read(null);
    this.changed({sequence: sequenceName(this.sequence), plane: this.plane, runs: runs.map((run) => run.id)});
  }
  pointedAt(time, fromCanvas) {
    this.canvas.mark(time);
    if (fromCanvas) this.plot.mark(time);
    this.read(time);
  }
  /// Says the errors at a time in words.
  read(time) {
    const parts = [];
    for (const {name, error} of time === null ? [] : this.lines) {
      if (!error || error.t.length === 0) continue;
      const i = nearestPlace(error.t, time);
      if (Math.abs(error.t[i] - time) < 0.5 && error.e[i] !== null) parts.push(`${name} ${errorText(error.e[i])} m`);
    }
    byId('readout').textContent = time === null ? 'Point at a line to read the errors at that time.' :
                                                  `${fixed(time, 2)} s: ${parts.join(' · ') || 'no pose'}`;
  }
}
