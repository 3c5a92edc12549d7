// Points, lines and the mesh without a graphics card. What stands in for one is another process that spends more than a microsecond on
// each point, and as much again on handing its picture over. Here the map is drawn into an image in memory; a browser that
// offers no WebGL at all shows it as well.

/// Whether a context draws by the processor: by SwiftShader, llvmpipe or the like.
function drawsBySoftware(gl) {
  const names = gl.getExtension('WEBGL_debug_renderer_info');
  const renderer = String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}

/// A colour from 0 to 1 as the number that an image in memory has for it.
const isLittleEndian = new Uint8Array(new Uint32Array([1]).buffer)[0] === 1;
function packedColour([r, g, b]) {
  const bytes = [r, g, b, 1].map((value) => Math.round(255 * value));
  return (isLittleEndian ? bytes[0] | bytes[1] << 8 | bytes[2] << 16 | bytes[3] << 24
                         : bytes[0] << 24 | bytes[1] << 16 | bytes[2] << 8 | bytes[3]) >>> 0;
}

/// The same for red << 16 | green << 8 | blue.
const packedNumber = isLittleEndian ? (n) => (0xff000000 | (n & 255) << 16 | n & 0xff00 | n >> 16) >>> 0 : (n) => (n << 8 | 255) >>> 0;

/// An image with the distance of what each pixel shows; its first row is the highest.
class DepthImage {
  begin(width, height, ground) {
    if (this.width !== width || this.height !== height) {
      Object.assign(this, {width, height});
      this.data = new ImageData(width, height);
      this.bytes = this.data.data;
      this.pixels = new Uint32Array(this.bytes.buffer);
      this.depths = new Float32Array(width * height);
    }
    this.pixels.fill(packedColour(ground));
    this.depths.fill(Infinity);
  }
  /// Rows of points, those of `slots` or every `step`-th, as squares: `near` is their size in pixels at a distance of 1,
  /// `least` the smallest. `kind` and `colours` as the shader of points has them.
  drawPoints(rows, count, matrix, kind, colours, near, least, {slots = null, step = 1} = {}) {
    const {width, height, pixels, depths} = this;
    const packed = colours.map(packedColour), byLabel = Uint32Array.from({length: 256}, (_, label) => packed[classPlace(label)]);
    const [m0, m1, , m3, m4, m5, , m7, m8, m9, , m11, m12, m13, , m15] = matrix;
    const total = slots ? slots.length : count;
    const halfWidth = 0.5 * width, halfHeight = 0.5 * height, largest = 3 * least;
    for (let k = 0; k < total; k += step) {
      const at = pointWidth * (slots ? slots[k] : k);
      const x = rows[at], y = rows[at + 1], z = rows[at + 2], evidence = rows[at + 3];
      const w = Math.fround(m3 * x + m7 * y + m11 * z + m15);  // as it is kept: what is drawn later at the same place shows
      if (!(w > 1e-3) || evidence !== evidence) continue;
      const colour = kind === 0 ? packed[evidence > 0.5 ? 0 : evidence < -0.5 ? 3 : evidence === 0 ? 1 : 2]
          : kind === 1 ? byLabel[rows[at + 4]] : packedNumber(rows[at + 4]);
      const size = Math.max(1, Math.min(largest, Math.max(least, near / w)) + 0.5 | 0), shift = 0.5 * (size - 1);
      let left = Math.round((m0 * x + m4 * y + m8 * z + m12) / w * halfWidth + halfWidth - 0.5 - shift);
      let top = Math.round(halfHeight - 0.5 - shift - (m1 * x + m5 * y + m9 * z + m13) / w * halfHeight);
      const right = Math.min(width, left + size), bottom = Math.min(height, top + size);
      left = Math.max(0, left);
      top = Math.max(0, top);
      for (let row = top; row < bottom; ++row)
        for (let i = row * width + left, end = row * width + right; i < end; ++i)
          if (depths[i] >= w) {
            depths[i] = w;
            pixels[i] = colour;
          }
    }
  }
  /// A group of the mesh by triangles of one colour each, without their backs and what is above the cut.
  drawGroup({data, indices, count}, matrix, light) {
    const {width, height, pixels, depths} = this;
    const places = new Float32Array(data), bytes = new Uint8Array(data), row = vertexBytes / 4;
    if (!(this.corners?.length >= 3 * count)) this.corners = new Float32Array(6 * count);
    const screen = this.corners, [m0, m1, , m3, m4, m5, , m7, m8, m9, , m11, m12, m13, , m15] = matrix;
    for (let i = 0; i < count; ++i) {
      const x = places[row * i], y = places[row * i + 1], z = places[row * i + 2];
      const w = m3 * x + m7 * y + m11 * z + m15, isShown = w > 1e-3 && light.up[0] * x + light.up[1] * y + light.up[2] * z <= light.cut;
      screen[3 * i] = ((m0 * x + m4 * y + m8 * z + m12) / w + 1) * 0.5 * width;
      screen[3 * i + 1] = (1 - (m1 * x + m5 * y + m9 * z + m13) / w) * 0.5 * height;
      screen[3 * i + 2] = isShown ? 1 / w : 0;
    }
    for (let k = 0; k < indices.length; k += 3) {
      const a = 3 * indices[k], b = 3 * indices[k + 1], c = 3 * indices[k + 2];
      const na = screen[a + 2], nb = screen[b + 2], nc = screen[c + 2];
      if (na === 0 || nb === 0 || nc === 0) continue;
      const ax = screen[a], ay = screen[a + 1], bx = screen[b] - ax, by = screen[b + 1] - ay, cx = screen[c] - ax, cy = screen[c + 1] - ay;
      const area = by * cx - bx * cy;  // rows count downwards
      if (!(area > 0)) continue;
      const left = Math.max(0, Math.ceil(ax + Math.min(0, bx, cx) - 0.5)), right = Math.min(width - 1, Math.floor(ax + Math.max(0, bx, cx) - 0.5));
      const top = Math.max(0, Math.ceil(ay + Math.min(0, by, cy) - 0.5)), bottom = Math.min(height - 1, Math.floor(ay + Math.max(0, by, cy) - 0.5));
      if (left > right || top > bottom) continue;
      const colour = this.litColour(places, bytes, indices[k], light), inverse = 1 / area;
      for (let y = top; y <= bottom; ++y)
        for (let x = left; x <= right; ++x) {
          const px = x + 0.5 - ax, py = y + 0.5 - ay, u = (py * cx - px * cy) * inverse, v = (by * px - bx * py) * inverse;
          if (u < -1e-6 || v < -1e-6 || u + v > 1.000001) continue;
          const w = 1 / (na + u * (nb - na) + v * (nc - na)), pixel = y * width + x;
          if (depths[pixel] < w) continue;
          depths[pixel] = w;
          pixels[pixel] = colour;
        }
    }
  }
  /// As the shader of the mesh has it.
  litColour(places, bytes, vertex, {eye, up, classes}) {
    const at = vertexBytes * vertex + 12, row = vertexBytes / 4 * vertex;
    const n = [bytes[at] / 127.5 - 1, bytes[at + 1] / 127.5 - 1, bytes[at + 2] / 127.5 - 1];
    const to = [eye[0] - places[row], eye[1] - places[row + 1], eye[2] - places[row + 2]];
    const light = 0.45 + 0.43 * Math.max(0, dot(n, to) / norm(to)) + 0.06 * (1 + dot(n, up));
    const own = classes ? classes[classPlace(bytes[at + 3])] : null;
    const part = (i) => Math.min(255, (own ? 255 * own[i] : bytes[at + 4 + i]) * light) | 0;
    return packedNumber(part(0) << 16 | part(1) << 8 | part(2));
  }
  /// Segments of Lines, so many pixels wide; points in front of them stay, unless they are drawn over everything.
  drawLines(values, matrix, width, isAbove = false) {
    const [m0, m1, , m3, m4, m5, , m7, m8, m9, , m11, m12, m13, , m15] = matrix;
    const halfWidth = 0.5 * this.width, halfHeight = 0.5 * this.height, nearest = 1e-3;
    for (let at = 0; at < values.length; at += 10) {
      const ax = values[at], ay = values[at + 1], az = values[at + 2], bx = values[at + 3], by = values[at + 4], bz = values[at + 5];
      let pw = m3 * ax + m7 * ay + m11 * az + m15, qw = m3 * bx + m7 * by + m11 * bz + m15;
      if (!(pw > nearest) && !(qw > nearest)) continue;
      let px = m0 * ax + m4 * ay + m8 * az + m12, py = m1 * ax + m5 * ay + m9 * az + m13;
      let qx = m0 * bx + m4 * by + m8 * bz + m12, qy = m1 * bx + m5 * by + m9 * bz + m13;
      if (pw < nearest) {
        const share = (nearest - pw) / (qw - pw);
        px += share * (qx - px), py += share * (qy - py), pw = nearest;
      } else if (qw < nearest) {
        const share = (nearest - qw) / (pw - qw);
        qx += share * (px - qx), qy += share * (py - qy), qw = nearest;
      }
      this.drawSegment(px / pw * halfWidth + halfWidth, halfHeight - py / pw * halfHeight, isAbove ? Infinity : 1 / pw,
                       qx / qw * halfWidth + halfWidth, halfHeight - qy / qw * halfHeight, isAbove ? Infinity : 1 / qw,
                       255 * values[at + 6], 255 * values[at + 7], 255 * values[at + 8], values[at + 9], width);
    }
  }
  /// From pixel to pixel, the reciprocals of the distances beside them. Each column (or row, of steep ones) of the image gets
  /// the share of its pixels that the line covers.
  drawSegment(x0, y0, near0, x1, y1, near1, red, green, blue, alpha, lineWidth) {
    const {width, height, bytes, depths} = this;
    const isSteep = Math.abs(y1 - y0) > Math.abs(x1 - x0);
    if (isSteep) [x0, y0, x1, y1] = [y0, x0, y1, x1];  // from here on along x
    if (x0 > x1) [x0, y0, near0, x1, y1, near1] = [x1, y1, near1, x0, y0, near0];
    const length = isSteep ? height : width, breadth = isSteep ? width : height, along = isSteep ? width : 1, across = isSteep ? 1 : width;
    const run = x1 - x0, slope = run > 1e-6 ? (y1 - y0) / run : 0, fall = run > 1e-6 && near0 !== near1 ? (near1 - near0) / run : 0;
    const half = 0.5 * lineWidth * Math.sqrt(1 + slope * slope);
    const begin = Math.max(0, Math.floor(x0)), end = Math.min(length - 1, Math.floor(x1));
    for (let i = begin; i <= end; ++i) {
      const covered = Math.min(i + 1, x1) - Math.max(i, x0), middle = Math.min(x1, Math.max(x0, i + 0.5)) - x0;
      const y = y0 + slope * middle, near = near0 + fall * middle;
      const share = alpha * (run > 1 ? covered : Math.max(covered, Math.min(1, lineWidth) / (end - begin + 1)));
      const low = Math.max(0, Math.floor(y - half)), high = Math.min(breadth - 1, Math.floor(y + half));
      for (let k = low; k <= high; ++k) {
        const pixel = along * i + across * k;
        if (depths[pixel] * near < 1) continue;
        const part = share * (Math.min(k + 1, y + half) - Math.max(k, y - half)), rest = 1 - part, byte = 4 * pixel;
        bytes[byte] = rest * bytes[byte] + part * red;
        bytes[byte + 1] = rest * bytes[byte + 1] + part * green;
        bytes[byte + 2] = rest * bytes[byte + 2] + part * blue;
      }
    }
  }
}

/// Draws like Renderer, by the processor.
class SoftRenderer {
  constructor(canvas) {
    Object.assign(this, {canvas, isSoft: true, byClass: false, cut: Infinity, groups: [], seen: 0, image: new DepthImage(), sets: new Map()});
    for (const name of ['pointBuffer', 'movingBuffer', 'cloudBuffer']) this[name] = {data: new Float32Array(), count: 0};
    this.context = canvas.getContext('2d', {alpha: false, willReadFrequently: true});
  }
  setPoints(target, data, count) { Object.assign(target, {data, count}); }
  setSeen(slots) { Object.assign(this, {seenSlots: slots, seen: slots.length}); }
  setGroup(number, group) { this.groups[number] = group; }
  clearMesh() { this.groups = []; }
  setLines(name, lines, width) { this.sets.set(name, {values: Float32Array.from(lines.values), width}); }
  draw(view, shown, step = 1) {
    const {canvas, image} = this;
    const width = Math.max(1, Math.round(canvas.clientWidth)), height = Math.max(1, Math.round(canvas.clientHeight));
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    const matrix = view.matrix(width / height);
    image.begin(width, height, cssColour('--map-ground'));
    const light = {eye: view.eye(), up: view.up, cut: this.cut, classes: this.byClass && this.meshHasClasses ? classColours() : null};
    if (shown.mesh !== false) for (const group of this.groups) if (group) image.drawGroup(group, matrix, light);
    for (const {target, slots, kind, colours, near, least} of pointLayers(this, shown))
      image.drawPoints(target.data, target.count, matrix, kind, colours, near * height, least, {slots, step: slots ? 1 : step});
    for (const [name, set] of this.sets)
      if (shown[name] !== false && name !== 'camera') image.drawLines(set.values, matrix, set.width);
    const camera = this.sets.get('camera');
    if (camera) image.drawLines(camera.values, matrix, camera.width, true);
    this.context.putImageData(image.data, 0, 0);
  }
  finish() {}
  /// Red, green, blue and 255 of a pixel; the first row is the highest.
  pixel(x, y) { return [...this.image.bytes.subarray(4 * (y * this.image.width + x), 4 * (y * this.image.width + x) + 4)]; }
}
