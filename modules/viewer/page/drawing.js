// Points, lines and the mesh by WebGL 2, and colours.

const pointShader = `#version 300 es
precision highp float;
layout(location = 0) in vec4 point;  // place and evidence
layout(location = 1) in float tint;  // class, or colour
uniform mat4 matrix;
uniform int kind;         // of colour: 0 by evidence, 1 by class, 2 the point's own
uniform vec4 colours[8];  // by evidence: static, not measured, doubtful, moving; or by class
uniform vec2 size;        // on the screen: at a distance of 1, and least
out vec4 colour;
void main() {
  gl_Position = matrix * vec4(point.xyz, 1.0);
  gl_PointSize = clamp(size.x / gl_Position.w, size.y, 3.0 * size.y);
  float e = point.w;
  int packed = int(tint);
  if (kind == 0) colour = colours[e > 0.5 ? 0 : e < -0.5 ? 3 : e == 0.0 ? 1 : 2];
  else if (kind == 1) colour = colours[packed == 255 ? 7 : packed == 0 ? 0 : (packed - 1) % 6 + 1];
  else colour = vec4(vec3(packed >> 16, packed >> 8 & 255, packed & 255) / 255.0, 1.0);
  if (!(e == e)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;
const pointFragment = `#version 300 es
precision mediump float;
in vec4 colour;
out vec4 pixel;
void main() {
  vec2 d = gl_PointCoord - 0.5;
  if (dot(d, d) > 0.25) discard;
  pixel = colour;
}`;
// Each segment is a rectangle on the screen, because lines of WebGL are one pixel wide; both ends come with each of its
// four corners. Instances would be shorter, but renderers without a graphics card draw them one by one.
const lineShader = `#version 300 es
precision highp float;
layout(location = 0) in vec3 a;
layout(location = 1) in vec3 b;
layout(location = 2) in vec4 tint;
uniform mat4 matrix;
uniform vec2 screen;
uniform float width;
out vec4 colour;
void main() {
  vec4 p = matrix * vec4(a, 1.0), q = matrix * vec4(b, 1.0);
  float near = 1e-3;
  if (p.w < near && q.w < near) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  if (p.w < near) p = mix(p, q, (near - p.w) / (q.w - p.w));
  if (q.w < near) q = mix(q, p, (near - q.w) / (p.w - q.w));
  vec2 along = (q.xy / q.w - p.xy / p.w) * screen;
  float length_of = length(along);
  vec2 across = length_of > 1e-6 ? vec2(-along.y, along.x) / length_of : vec2(0.0, 1.0);
  bool isEnd = (gl_VertexID & 1) == 1;
  vec4 end = isEnd ? q : p;
  float side = (gl_VertexID & 2) == 2 ? 1.0 : -1.0;
  end.xy += across * side * width / screen * end.w;
  gl_Position = end;
  colour = tint;
}`;
const lineFragment = `#version 300 es
precision mediump float;
in vec4 colour;
out vec4 pixel;
void main() { pixel = colour; }`;

// The light comes from the eye and a little from above; the back of a surface is not drawn, so that one looks into a room.
const meshShader = `#version 300 es
precision highp float;
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 normal;  // and class
layout(location = 2) in vec4 tint;
uniform mat4 matrix;
uniform vec3 eye;
uniform vec3 up;
uniform bool byClass;
uniform vec4 colours[8];  // by class
out vec3 colour;
out float height;
void main() {
  gl_Position = matrix * vec4(place, 1.0);
  height = dot(place, up);
  int label = int(normal.w * 255.0 + 0.5);
  vec3 own = byClass ? colours[label == 255 ? 7 : label == 0 ? 0 : (label - 1) % 6 + 1].rgb : tint.rgb;
  vec3 n = normal.xyz * 2.0 - 1.0;
  float facing = max(0.0, dot(n, normalize(eye - place)));
  colour = own * (0.45 + 0.43 * facing + 0.06 * (1.0 + dot(n, up)));
}`;
const meshFragment = `#version 300 es
precision highp float;
in vec3 colour;
in float height;
uniform float cut;
out vec4 pixel;
void main() {
  if (height > cut) discard;
  pixel = vec4(colour, 1.0);
}`;

/// A colour of the style sheet as [r, g, b, a] from 0 to 1.
const colourCache = new Map();
function cssColour(name, alpha = 1) {
  if (!colourCache.has(name)) {
    const probe = document.createElement('span');
    probe.style.color = `var(${name})`;
    document.body.append(probe);
    const [r, g, b] = getComputedStyle(probe).color.match(/[\d.]+/g).map(Number);
    probe.remove();
    colourCache.set(name, [r / 255, g / 255, b / 255]);
  }
  return [...colourCache.get(name), alpha];
}
/// From green over amber to red, for a share from 0 to 1.
function rampColour(share) {
  const [low, middle, high] = ['--static', '--doubtful', '--moving'].map((name) => cssColour(name));
  return share < 0.5 ? mix(low, middle, 2 * share) : mix(middle, high, 2 * share - 1);
}
/// Of a moving object: each number is as far on the circle of hues as the golden ratio says, so that those near each other
/// differ and none comes twice.
function objectColour(id, alpha = 1) {
  const hue = (200 + 137.508 * id) % 360;
  const channel = (n) => { const k = (n + hue / 30) % 12; return 0.52 - 0.38 * Math.max(-1, Math.min(k - 3, 9 - k, 1)); };
  return [...mix([channel(0), channel(8), channel(4)], cssColour('--text'), 0.15), alpha];
}

/// Colours of classes, the same on the map as over the picture. Label 0 is the background.
const classTints = [[30, 120, 255], [200, 0, 200], [0, 200, 200], [255, 140, 0], [120, 220, 120], [150, 110, 255]];
/// The place of a label among the colours of classColours(); more classes than colours begin anew.
const classPlace = (label) => (label === unknownClass ? 7 : label === 0 ? 0 : (label - 1) % classTints.length + 1);
/// Colours by classPlace().
const classColours = () => [cssColour('--static'), ...classTints.map((tint) => [...tint.map((x) => x / 255), 1]), cssColour('--unmeasured')];

/// Segments with a colour each.
class Lines {
  constructor() { this.clear(); }
  clear() { this.values = []; }
  add(a, b, colour) { this.values.push(a[0], a[1], a[2], b[0], b[1], b[2], colour[0], colour[1], colour[2], colour[3] ?? 1); }
  addBox(pose, low, high, colour) {
    const corner = (i) => transform(pose, [i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]]);
    for (let i = 0; i < 8; ++i)
      for (const axis of [1, 2, 4])
        if (!(i & axis)) this.add(corner(i), corner(i | axis), colour);
  }
  addFrustum(pose, [width, height, fx, fy, cx, cy], depth, colour) {
    const corner = (x, y) => transform(pose, [(x - cx) / fx * depth, (y - cy) / fy * depth, depth]);
    const corners = [corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)];
    for (let i = 0; i < 4; ++i) {
      this.add(pose, corners[i], colour);
      this.add(corners[i], corners[(i + 1) % 4], colour);
    }
  }
}

/// What is drawn as points: {target, slots, kind, colours, near, least}; the sizes as shares of the height and in pixels.
function pointLayers(renderer, shown) {
  const red = cssColour('--moving'), layers = [];
  if (shown.cloud !== false && renderer.cloudBuffer.count)
    layers.push({target: renderer.cloudBuffer, kind: 2, colours: Array(8).fill(red), near: 0.012, least: 1.6});
  if (shown.points !== false && renderer.pointBuffer.count) {
    const evidence = [cssColour('--static'), cssColour('--unmeasured'), cssColour('--doubtful'), red];
    layers.push({target: renderer.pointBuffer, kind: renderer.byClass ? 1 : 0, colours: renderer.byClass ? classColours() : [...evidence, ...evidence],
                 near: 0.014, least: 2.2});
    if (renderer.seen && shown.seen !== false && !renderer.byClass)
      layers.push({target: renderer.pointBuffer, slots: renderer.seenSlots, kind: 0, colours: Array(8).fill(cssColour('--accent')), near: 0.02, least: 3});
  }
  if (shown.moving !== false && renderer.movingBuffer.count)
    layers.push({target: renderer.movingBuffer, kind: 0, colours: Array(8).fill(red), near: 0.02, least: 2.4});
  return layers;
}

/// Draws by a graphics card.
class Renderer {
  constructor(canvas, gl) {
    Object.assign(this, {canvas, gl, isSoft: false});
    this.points = this.program(pointShader, pointFragment, ['matrix', 'kind', 'colours', 'size']);
    this.lines = this.program(lineShader, lineFragment, ['matrix', 'screen', 'width']);
    this.pointBuffer = this.pointArray();
    this.seenBuffer = gl.createBuffer();
    this.movingBuffer = this.pointArray();
    this.cloudBuffer = this.pointArray();
    this.surface = this.program(meshShader, meshFragment, ['matrix', 'eye', 'up', 'byClass', 'colours', 'cut']);
    this.groups = [];      // of the mesh
    this.byClass = false;  // colours of map points and of the mesh
    this.cut = Infinity;   // height above which the mesh is cut away
    this.sets = new Map();
    this.cornerBuffer = gl.createBuffer();
    this.corners = 0;
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }
  program(vertex, fragment, uniforms) {
    const gl = this.gl, made = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    return {program: made, ...Object.fromEntries(uniforms.map((name) => [name, gl.getUniformLocation(made, name)]))};
  }
  pointArray() {
    const gl = this.gl, array = gl.createVertexArray(), buffer = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(0);
    gl.enableVertexAttribArray(1);
    this.setStep({buffer}, 1);
    return {array, buffer, capacity: 0, count: 0};
  }
  /// Takes over rows of points; only those of `range` have changed, if the buffer has room.
  setPoints(target, data, count, range = null) {
    const gl = this.gl;
    target.count = count;
    gl.bindBuffer(gl.ARRAY_BUFFER, target.buffer);
    if (target.capacity < data.length || !range) {
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
      target.capacity = data.length;
    } else {
      gl.bufferSubData(gl.ARRAY_BUFFER, 4 * pointWidth * range[0], data, pointWidth * range[0], pointWidth * (range[1] - range[0] + 1));
    }
  }
  setSeen(slots) {
    const gl = this.gl;
    this.seenSlots = slots;
    this.seen = slots.length;
    gl.bindVertexArray(this.pointBuffer.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.seenBuffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, slots, gl.DYNAMIC_DRAW);
    gl.bindVertexArray(null);
  }
  /// Takes over a group of the mesh.
  setGroup(number, {data, indices}) {
    const gl = this.gl;
    if (!this.groups[number]) {
      const array = gl.createVertexArray(), buffer = gl.createBuffer(), indexBuffer = gl.createBuffer();
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indexBuffer);
      [[0, 3, gl.FLOAT, 0], [1, 4, gl.UNSIGNED_BYTE, 12], [2, 4, gl.UNSIGNED_BYTE, 16]].forEach(([place, size, type, offset]) => {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, size, type, type === gl.UNSIGNED_BYTE, vertexBytes, offset);
      });
      this.groups[number] = {array, buffer, indexBuffer};
    }
    const group = this.groups[number];
    gl.bindVertexArray(group.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, group.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.DYNAMIC_DRAW);
    gl.bindVertexArray(null);
    group.count = indices.length;
  }
  clearMesh() {
    const gl = this.gl;
    for (const {array, buffer, indexBuffer} of this.groups) {
      gl.deleteVertexArray(array);
      gl.deleteBuffer(buffer);
      gl.deleteBuffer(indexBuffer);
    }
    this.groups = [];
  }
  drawMesh(view, matrix) {
    const gl = this.gl, {program, ...places} = this.surface;
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.matrix, false, matrix);
    gl.uniform3fv(places.eye, view.eye());
    gl.uniform3fv(places.up, view.up);
    gl.uniform1i(places.byClass, this.byClass && this.meshHasClasses ? 1 : 0);
    gl.uniform4fv(places.colours, new Float32Array(classColours().flat()));
    gl.uniform1f(places.cut, Math.min(this.cut, 1e9));
    gl.enable(gl.CULL_FACE);
    for (const group of this.groups) {
      if (!group?.count) continue;
      gl.bindVertexArray(group.array);
      gl.drawElements(gl.TRIANGLES, group.count, gl.UNSIGNED_INT, 0);
    }
    gl.disable(gl.CULL_FACE);
  }
  setLines(name, lines, width) {
    const gl = this.gl, count = lines.values.length / 10;
    if (!this.sets.has(name)) {
      const array = gl.createVertexArray(), buffer = gl.createBuffer();
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.cornerBuffer);
      [[0, 3, gl.FLOAT, 0], [1, 3, gl.FLOAT, 12], [2, 4, gl.UNSIGNED_BYTE, 24]].forEach(([place, size, type, offset]) => {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, size, type, type === gl.UNSIGNED_BYTE, 28, offset);
      });
      this.sets.set(name, {array, buffer});
    }
    gl.bindVertexArray(null);
    this.reserveCorners(count);
    const bytes = new ArrayBuffer(112 * count), floats = new Float32Array(bytes), colours = new Uint8Array(bytes);
    for (let i = 0; i < count; ++i)
      for (let corner = 0; corner < 4; ++corner) {
        const at = 4 * i + corner;
        for (let k = 0; k < 6; ++k) floats[7 * at + k] = lines.values[10 * i + k];
        for (let k = 0; k < 4; ++k) colours[28 * at + 24 + k] = Math.round(255 * lines.values[10 * i + 6 + k]);
      }
    const set = this.sets.get(name);
    gl.bindBuffer(gl.ARRAY_BUFFER, set.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, bytes, gl.DYNAMIC_DRAW);
    set.count = count;
    set.width = width;
  }
  /// Indices of two triangles for each of so many segments.
  reserveCorners(count) {
    if (count <= this.corners) return;
    const gl = this.gl;
    this.corners = Math.max(2 * this.corners, count, 1024);
    const indices = new Uint32Array(6 * this.corners);
    for (let i = 0; i < this.corners; ++i) indices.set([4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 2, 4 * i + 1, 4 * i + 3], 6 * i);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.cornerBuffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  }

  /// `step`: every so many points are drawn.
  draw(view, shown, step = 1) {
    const gl = this.gl, canvas = this.canvas;
    const ratio = Math.min(2, devicePixelRatio || 1);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    gl.viewport(0, 0, width, height);
    gl.clearColor(...cssColour('--map-ground'));
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const matrix = view.matrix(width / height);
    if (shown.mesh !== false && this.groups.length) this.drawMesh(view, matrix);
    gl.useProgram(this.lines.program);
    gl.uniformMatrix4fv(this.lines.matrix, false, matrix);
    gl.uniform2f(this.lines.screen, width, height);
    for (const [name, set] of this.sets) {
      if (shown[name] === false || !set.count) continue;
      gl.bindVertexArray(set.array);
      gl.uniform1f(this.lines.width, set.width * ratio);
      if (name === 'camera') continue;  // drawn last, over everything
      gl.drawElements(gl.TRIANGLES, 6 * set.count, gl.UNSIGNED_INT, 0);
    }
    this.drawPoints(matrix, shown, step, height, ratio);
    const camera = this.sets.get('camera');
    if (camera?.count) {
      gl.useProgram(this.lines.program);
      gl.bindVertexArray(camera.array);
      gl.uniform1f(this.lines.width, camera.width * ratio);
      gl.disable(gl.DEPTH_TEST);
      gl.drawElements(gl.TRIANGLES, 6 * camera.count, gl.UNSIGNED_INT, 0);
      gl.enable(gl.DEPTH_TEST);
    }
    gl.bindVertexArray(null);
  }
  /// Waits until everything is drawn: only reading a pixel does.
  finish() { this.pixel(0, 0); }
  /// Red, green, blue and 255 of a pixel; the first row is the highest.
  pixel(x, y) {
    const pixel = new Uint8Array(4);
    this.gl.readPixels(x, this.canvas.height - 1 - y, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, pixel);
    return [...pixel];
  }
  drawPoints(matrix, shown, step, height, ratio) {
    const gl = this.gl;
    gl.useProgram(this.points.program);
    gl.uniformMatrix4fv(this.points.matrix, false, matrix);
    for (const {target, slots, kind, colours, near, least} of pointLayers(this, shown)) {
      gl.bindVertexArray(target.array);
      gl.uniform1i(this.points.kind, kind);
      gl.uniform4fv(this.points.colours, new Float32Array(colours.flat()));
      gl.uniform2f(this.points.size, near * height, least * ratio);
      if (slots) {
        gl.drawElements(gl.POINTS, slots.length, gl.UNSIGNED_INT, 0);
      } else {
        this.setStep(target, step);
        gl.drawArrays(gl.POINTS, 0, Math.floor(target.count / step));
        this.setStep(target, 1);
      }
    }
  }
  setStep({buffer}, step) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 4 * pointWidth * step, 0);
    gl.vertexAttribPointer(1, 1, gl.FLOAT, false, 4 * pointWidth * step, 16);
  }
}

/// What draws on a canvas: a graphics card where there is one, else the processor. The fragment #webgl of the address asks for
/// WebGL in any case.
function makeRenderer(canvas) {
  const isForced = location.hash === '#webgl';
  const gl = canvas.getContext('webgl2', {antialias: false, alpha: false, failIfMajorPerformanceCaveat: !isForced});
  if (gl && (isForced || !drawsBySoftware(gl))) return new Renderer(canvas, gl);
  if (!gl) return new SoftRenderer(canvas);
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  const other = canvas.cloneNode();  // a canvas has one kind of context for ever
  canvas.replaceWith(other);
  return new SoftRenderer(other);
}
