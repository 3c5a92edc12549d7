// The mesh of the surface as it grows: patches by slot, and groups of them, each of which is drawn at once.

const patchesInGroup = 64;
const vertexBytes = 20;  // x y z as floats; normal, class, red, green, blue, 255 as bytes

class Mesh {
  constructor() { this.clear(); }
  clear() {
    Object.assign(this, {patches: [], hasClasses: false, triangles: 0});
    this.changedGroups = new Set(['all']);
  }
  /// Takes over the patches of a message; returns whether there were any.
  take(json, arrays, seenClasses) {
    if (json.new_mesh) this.clear();
    const {patch_slots: slots, patch_sizes: sizes, patch_places: places, patch_tints: tints, patch_corners: corners} = arrays;
    let vertex = 0, corner = 0;
    for (let i = 0; i < (slots?.length ?? 0); ++i) {
      const count = sizes[2 * i], triangles = sizes[2 * i + 1];
      const patch = {
        count, places: places?.slice(3 * vertex, 3 * (vertex + count)) ?? new Float32Array(), tints: tints?.slice(8 * vertex, 8 * (vertex + count)) ?? new Uint8Array(),
        corners: corners?.slice(corner, corner + 3 * triangles) ?? new Uint16Array(),
      };
      for (let k = 3; k < patch.tints.length; k += 8) {
        seenClasses.add(patch.tints[k]);
        this.hasClasses ||= patch.tints[k] !== unknownClass;
      }
      this.triangles += triangles - (this.patches[slots[i]]?.corners.length ?? 0) / 3;
      this.patches[slots[i]] = patch;
      this.changedGroups.add(Math.floor(slots[i] / patchesInGroup));
      vertex += count;
      corner += 3 * triangles;
    }
    return Boolean(json.new_mesh || slots);
  }
  groupCount() { return Math.ceil(this.patches.length / patchesInGroup); }
  /// Vertices and indices of a group.
  group(number) {
    const patches = this.patches.slice(patchesInGroup * number, patchesInGroup * (number + 1)).filter(Boolean);
    const count = patches.reduce((sum, patch) => sum + patch.count, 0);
    const data = new ArrayBuffer(vertexBytes * count), floats = new Float32Array(data), bytes = new Uint8Array(data);
    const indices = new Uint32Array(patches.reduce((sum, patch) => sum + patch.corners.length, 0));
    let vertex = 0, corner = 0;
    for (const patch of patches) {
      for (const index of patch.corners) indices[corner++] = vertex + index;
      for (let i = 0; i < patch.count; ++i, ++vertex) {
        floats.set(patch.places.subarray(3 * i, 3 * i + 3), vertexBytes / 4 * vertex);
        bytes.set(patch.tints.subarray(8 * i, 8 * i + 8), vertexBytes * vertex + 12);
      }
    }
    return {data, indices, count};
  }
  /// Lowest and highest place along a direction, by a vertex of each patch.
  heights(up) {
    let low = Infinity, high = -Infinity;
    for (const patch of this.patches) {
      if (!patch?.count) continue;
      const height = dot(patch.places, up);
      low = Math.min(low, height);
      high = Math.max(high, height);
    }
    return [low, high];
  }
}
