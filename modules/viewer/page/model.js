// What the page knows of the run: everything that messages have said so far. modules/viewer/README.md describes them.

const arrayTypes = {u8: Uint8Array, u16: Uint16Array, u32: Uint32Array, f32: Float32Array, f64: Float64Array};

/// A message as {json, arrays by name}.
function decodeMessage(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const json = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
  const arrays = {};
  for (const [name, [type, offset, count]] of Object.entries(json.arrays ?? {}))
    arrays[name] = new arrayTypes[type](buffer, 8 + length + offset, count);
  return {json, arrays};
}

/// Numbers that grow at their end, `width` to a row.
class Rows {
  constructor(width, type = Float32Array) {
    this.width = width;
    this.data = new type(width * 256);
    this.count = 0;
  }
  reserve(rows) {
    if (rows * this.width <= this.data.length) return;
    const larger = new this.data.constructor(Math.max(rows * this.width, 2 * this.data.length));
    larger.set(this.data);
    this.data = larger;
  }
  append(values) {
    const rows = values.length / this.width;
    this.reserve(this.count + rows);
    this.data.set(values, this.count * this.width);
    this.count += rows;
  }
  row(i) { return this.data.subarray(i * this.width, (i + 1) * this.width); }
}

const statusNames = ['waiting', 'map begun', 'tracking', 'lost', 'found again', 'bridged by inertia'];
const statusKinds = ['warn', 'good', 'good', 'bad', 'warn', 'warn'];
const pathWidth = 9;  // x y z, quaternion x y z w, status, error

const pointWidth = 5;  // x y z, evidence (NaN = none), class; of the dense cloud: x y z, 0, colour as red << 16 | green << 8 | blue
const unknownClass = 255;

class Model {
  constructor() {
    this.head = {title: 'Holdfast', camera: [640, 480, 525, 525, 319.5, 239.5], frame_rate: 30, classes: []};
    this.state = {};
    this.stages = [];
    this.frames = [];        // the last ones: [timestamp, status, tracking ms, [stage, ms, ...]]
    this.history = new Rows(2, Float64Array);  // timestamp and status of every frame
    this.points = new Rows(pointWidth);        // by slot
    this.cloud = new Rows(pointWidth);         // in the world
    this.cloudPlaces = new Rows(3);            // the same in the frames of their keyframes
    this.surfaces = [];                        // of keyframes: {begin, count} in the cloud
    this.mesh = new Mesh();
    this.keyframes = new Map();                // by slot: {pose, stamp}
    this.covisibility = new Uint32Array();
    this.loops = new Uint32Array();
    this.closedLoops = 0;
    this.path = new Rows(pathWidth);
    this.stamps = new Rows(1, Float64Array);
    this.truth = null;       // {stamps, places}
    this.run = null;
    this.objects = [];
    this.trails = new Map();  // by object: Rows of places
    this.picture = null;
    this.seenClasses = new Set();  // labels that any point has had
    this.changed = new Set(['all']);
  }

  /// Takes over a message.
  apply({json, arrays}) {
    const mark = (what) => this.changed.add(what);
    if (json.head) { this.head = json.head; mark('head'); }
    if (json.state) { this.state = json.state; mark('state'); }
    if (json.stages) this.stages = json.stages;
    if (json.objects) { this.objects = json.objects; mark('objects'); }
    if (json.frames) this.addFrames(json.frames);
    if (arrays.point_slots) this.setPoints(arrays.point_slots, arrays.point_values, arrays.point_classes);
    this.takeCloud(json, arrays);
    if (this.mesh.take(json, arrays, this.seenClasses)) mark('mesh');
    if (arrays.keyframe_slots) this.setKeyframes(arrays);
    if (json.covisibility !== undefined) { this.covisibility = arrays.covisibility?.slice() ?? new Uint32Array(); mark('keyframes'); }
    if (json.loops !== undefined) { this.loops = arrays.loops?.slice() ?? new Uint32Array(); mark('keyframes'); }
    if (json.closed_loops !== undefined) { this.closedLoops = json.closed_loops; mark('loop'); }
    if (json.new_path) { this.path.count = this.stamps.count = 0; mark('path'); }
    if (arrays.moved_path) this.movePath(arrays.moved_path, arrays.moved_path_values);
    if (arrays.path_stamps) { this.stamps.append(arrays.path_stamps); this.path.append(arrays.path_values); mark('path'); }
    if (arrays.trail_ids) this.addTrails(arrays.trail_ids, arrays.trail_places);
    if (json.picture) this.setPicture(json.picture, arrays);
    if (json.run) {
      this.run = json.run;
      this.truth = arrays.truth_stamps ? {stamps: arrays.truth_stamps.slice(), places: arrays.truth_places.slice()} : null;
      mark('run'); mark('path');
    }
  }

  addFrames(frames) {
    this.frames.push(...frames);
    if (this.frames.length > 400) this.frames.splice(0, this.frames.length - 300);
    for (const [stamp, status] of frames) this.history.append([stamp, status]);
    this.changed.add('frames');
  }
  setPoints(slots, values, classes) {
    let least = Infinity, most = -1;
    for (const slot of slots) { least = Math.min(least, slot); most = Math.max(most, slot); }
    this.points.reserve(most + 1);
    for (let slot = this.points.count; slot <= most; ++slot) this.points.data[pointWidth * slot + 3] = NaN;
    this.points.count = Math.max(this.points.count, most + 1);
    for (let i = 0; i < slots.length; ++i) {
      this.points.data.set(values.subarray(4 * i, 4 * i + 4), pointWidth * slots[i]);
      this.points.data[pointWidth * slots[i] + 4] = classes?.[i] ?? unknownClass;
    }
    if (classes) for (const label of classes) this.seenClasses.add(label);
    this.changedPoints = [Math.min(least, this.changedPoints?.[0] ?? Infinity), Math.max(most, this.changedPoints?.[1] ?? -1)];
    this.changed.add('points');
  }
  /// The dense cloud: surfaces that keyframes see, each with a pose that moves with its keyframe.
  takeCloud(json, arrays) {
    if (json.new_cloud) {
      this.cloud.count = this.cloudPlaces.count = 0;
      this.surfaces = [];
      this.changed.add('cloud');
    }
    const {moved_surfaces: moved, surface_counts: counts} = arrays;
    for (let i = 0; i < (moved?.length ?? 0); ++i)
      this.placeSurface(this.surfaces[moved[i]], arrays.moved_surface_poses.subarray(7 * i, 7 * i + 7));
    if (counts) {
      const {surface_colours: colours} = arrays, rows = new Float32Array(pointWidth * colours.length / 3);
      for (let i = 0; 3 * i < colours.length; ++i) rows[pointWidth * i + 4] = colours[3 * i] << 16 | colours[3 * i + 1] << 8 | colours[3 * i + 2];
      let begin = this.cloud.count;
      this.cloud.append(rows);
      this.cloudPlaces.append(arrays.surface_places);
      counts.forEach((count, i) => {
        this.surfaces.push({begin, count});
        this.placeSurface(this.surfaces.at(-1), arrays.surface_poses.subarray(7 * i, 7 * i + 7));
        begin += count;
      });
    }
  }
  placeSurface({begin, count}, pose) {
    for (let i = begin; i < begin + count; ++i) this.cloud.data.set(transform(pose, this.cloudPlaces.row(i)), pointWidth * i);
    const [least, most] = this.changedCloud ?? [Infinity, -1];
    this.changedCloud = [Math.min(least, begin), Math.max(most, begin + count - 1)];
    this.changed.add('cloud');
  }
  setKeyframes({keyframe_slots: slots, keyframe_values: values, keyframe_stamps: stamps}) {
    for (let i = 0; i < slots.length; ++i) {
      const row = values.slice(8 * i, 8 * i + 8);
      if (row[7] > 0) this.keyframes.set(slots[i], {pose: row, stamp: stamps[i]});
      else this.keyframes.delete(slots[i]);
    }
    this.changed.add('keyframes');
  }
  movePath(rows, values) {
    for (let i = 0; i < rows.length; ++i) this.path.data.set(values.subarray(7 * i, 7 * i + 7), rows[i] * pathWidth);
    this.changed.add('path');
  }
  addTrails(ids, places) {
    for (let i = 0; i < ids.length; ++i) {
      if (!this.trails.has(ids[i])) this.trails.set(ids[i], new Rows(3));
      this.trails.get(ids[i]).append(places.subarray(3 * i, 3 * i + 3));
    }
    this.changed.add('objects');
  }
  setPicture(about, arrays) {
    const copy = (name, type) => arrays[name]?.slice() ?? new type();
    this.picture = {
      ...about, jpeg: new Blob([arrays.jpeg], {type: 'image/jpeg'}), mask: copy('mask', Uint8Array),
      places: copy('feature_places', Uint16Array), kinds: copy('feature_kinds', Uint8Array),
    };
    this.seen = copy('seen_points', Uint32Array);
    this.movingFeatures = copy('moving_features', Float32Array);
    this.changed.add('picture');
  }

  /// Pose number `i` of the path; the current one if there is no `i`.
  pose(i = null) {
    if (i !== null) return i < this.path.count ? this.path.row(i) : null;
    return this.state.pose ?? (this.path.count ? this.path.row(this.path.count - 1) : null);
  }
}
