// Points without a graphics card. What stands in for one spends more than a microsecond on each point; drawn here, into an
// image that is then one texture, they take a tenth of it.

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

/// An image with the distance of what each pixel shows; its first row is the lowest.
class PointImage {
  begin(width, height, ground) {
    if (this.width !== width || this.height !== height) {
      Object.assign(this, {width, height});
      this.pixels = new Uint32Array(width * height);
      this.depths = new Float32Array(width * height);
    }
    this.pixels.fill(packedColour(ground));
    this.depths.fill(Infinity);
  }
  /// Rows of points, those of `slots` or every `step`-th, as squares: `near` is their size in pixels at a distance of 1,
  /// `least` the smallest. `kind` and `colours` as the shader of points has them.
  draw(rows, count, matrix, kind, colours, near, least, {slots = null, step = 1} = {}) {
    const {width, height, pixels, depths} = this;
    const packed = colours.map(packedColour), byLabel = Uint32Array.from({length: 256}, (_, label) => packed[classPlace(label)]);
    const [m0, m1, , m3, m4, m5, , m7, m8, m9, , m11, m12, m13, , m15] = matrix;
    const total = slots ? slots.length : count;
    const halfWidth = 0.5 * width, halfHeight = 0.5 * height, largest = 3 * least;
    for (let k = 0; k < total; k += step) {
      const at = pointWidth * (slots ? slots[k] : k);
      const x = rows[at], y = rows[at + 1], z = rows[at + 2], evidence = rows[at + 3];
      const w = m3 * x + m7 * y + m11 * z + m15;
      if (!(w > 1e-3) || evidence !== evidence) continue;
      const colour = kind === 0 ? packed[evidence > 0.5 ? 0 : evidence < -0.5 ? 3 : evidence === 0 ? 1 : 2]
          : kind === 1 ? byLabel[rows[at + 4]] : packedNumber(rows[at + 4]);
      const size = Math.max(1, Math.min(largest, Math.max(least, near / w)) + 0.5 | 0), shift = 0.5 * (size - 1);
      let left = Math.round((m0 * x + m4 * y + m8 * z + m12) / w * halfWidth + halfWidth - 0.5 - shift);
      let low = Math.round((m1 * x + m5 * y + m9 * z + m13) / w * halfHeight + halfHeight - 0.5 - shift);
      const right = Math.min(width, left + size), high = Math.min(height, low + size);
      left = Math.max(0, left);
      low = Math.max(0, low);
      for (let row = low; row < high; ++row)
        for (let i = row * width + left, end = row * width + right; i < end; ++i)
          if (depths[i] > w) {
            depths[i] = w;
            pixels[i] = colour;
          }
    }
  }
}

const imageShader = `#version 300 es
out vec2 place;
void main() {
  place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  gl_Position = vec4(place * 2.0 - 1.0, 0.0, 1.0);
}`;
const imageFragment = `#version 300 es
precision mediump float;
uniform sampler2D image;
in highp vec2 place;
out vec4 pixel;
void main() { pixel = texture(image, place); }`;
