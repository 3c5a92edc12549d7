// SPDX-License-Identifier: BSD-3-Clause
// Wrote the recordings of this folder, once, with programs that are not of this project, so that the reader is not
// tested by its author's own idea of the formats:
//
//   npm install @mcap/core@2.2.2 @foxglove/rosmsg@5.0.5 @foxglove/rosmsg-serialization@2.0.4
//     @foxglove/rosmsg2-serialization@3.1.0 @foxglove/cdr@3.5.0 @foxglove/wasm-zstd@1.0.1 lz4js@0.2.0 sql.js@1.16.0
//   node write_bags.mjs FOLDER [many]
//
// `many`: all variants that these programs can write, which a test reads, in place of the recordings of this folder.
//
// Every recording has the same frames, as rosbag2_test.cpp computes them: colour(x, y, i) and depth(x, y, i).
import fs from "node:fs";
import path from "node:path";
import zlib from "node:zlib";
import { createRequire } from "node:module";

const require = createRequire(path.join(process.cwd(), "package.json"));
const { McapWriter } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const ros1 = require("@foxglove/rosmsg-serialization");
const ros2 = require("@foxglove/rosmsg2-serialization");
const { CdrWriter, EncapsulationKind } = require("@foxglove/cdr");
const zstd = require("@foxglove/wasm-zstd");
const lz4 = require("lz4js");
const initSqlJs = require("sql.js");

const folder = process.argv[2];
fs.mkdirSync(folder, { recursive: true });
await zstd.isLoaded;
const SQL = await initSqlJs();

const width = 16, height = 12, frames = 4;
const header2 = "\n================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id" +
  "\n================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec";
const header1 = "\n================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id";
const fields = {
  Image: "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data",
  CompressedImage: "std_msgs/Header header\nstring format\nuint8[] data",
  CameraInfo: (d, k, r, p) => "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\n" +
    `float64[] ${d}\nfloat64[9] ${k}\nfloat64[9] ${r}\nfloat64[12] ${p}\nuint32 binning_x\nuint32 binning_y\n` +
    "sensor_msgs/RegionOfInterest roi\n================\nMSG: sensor_msgs/RegionOfInterest\n" +
    "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify",
};
const definition = (version, type) => {
  const names = version === 1 ? ["D", "K", "R", "P"] : ["d", "k", "r", "p"];
  const own = type === "CameraInfo" ? fields.CameraInfo(...names) : fields[type];
  return own + (version === 1 ? header1 : header2);
};

const colour = (x, y, i) => [(7 * x + 40 * i) & 255, (11 * y) & 255, (x ^ y) & 255]; // blue, green, red
const depth = (x, y, i) => (x === 0 && y === 0 ? 0 : 500 + 10 * x + 20 * y + 100 * i); // millimetres
const colourTime = (i) => ({ sec: 1700000000, nsec: 900000000 + 33000000 * i });
const depthTime = (i) => ({ sec: 1700000000, nsec: 902000000 + 33000000 * i });
const normal = ({ sec, nsec }) => ({ sec: sec + Math.floor(nsec / 1e9), nsec: nsec % 1e9 });
const nanoseconds = (time) => BigInt(time.sec) * 1000000000n + BigInt(time.nsec) + 5000000n; // received 5 ms later
const head = (version, time, frame_id, i) => {
  const { sec, nsec } = normal(time);
  return version === 1 ? { seq: i, stamp: { sec, nsec }, frame_id } : { stamp: { sec, nanosec: nsec }, frame_id };
};

const colourBytes = (i) => {
  const data = new Uint8Array(3 * width * height);
  for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) data.set(colour(x, y, i), 3 * (y * width + x));
  return data;
};
const depthBytes = (i) => {
  const data = new DataView(new ArrayBuffer(2 * width * height));
  for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) data.setUint16(2 * (y * width + x), depth(x, y, i), true);
  return new Uint8Array(data.buffer);
};
function png(bits, channels, rows) {
  const table = [...Array(256).keys()].map((n) => { for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1; return n >>> 0; });
  const part = (name, content) => {
    const body = Buffer.concat([Buffer.from(name), content]);
    let crc = 0xffffffff;
    for (const byte of body) crc = table[(crc ^ byte) & 255] ^ (crc >>> 8);
    const length = Buffer.alloc(4), sum = Buffer.alloc(4);
    length.writeUInt32BE(content.length);
    sum.writeUInt32BE((crc ^ 0xffffffff) >>> 0);
    return Buffer.concat([length, body, sum]);
  };
  const size = Buffer.alloc(13);
  size.writeUInt32BE(width, 0);
  size.writeUInt32BE(height, 4);
  size.set([bits, channels === 3 ? 2 : 0, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), part("IHDR", size),
    part("IDAT", zlib.deflateSync(Buffer.concat(rows.flatMap((row) => [Buffer.from([0]), row])))), part("IEND", Buffer.alloc(0))]);
}
const colourPng = (i) => png(8, 3, [...Array(height).keys()].map((y) => Buffer.from([...Array(width).keys()].flatMap((x) => colour(x, y, i).reverse()))));
const depthPng = (i) => png(16, 1, [...Array(height).keys()].map((y) => Buffer.from([...Array(width).keys()].flatMap((x) => [depth(x, y, i) >> 8, depth(x, y, i) & 255]))));

const image = (version, time, i, encoding, channels, data) => ({
  header: head(version, time, "camera_color_optical_frame", i), height, width, encoding, is_bigendian: 0, step: channels * width, data });
const compressed = (version, time, i, format, data) => ({ header: head(version, time, "camera", i), format, data });
const cameraInfo = (version, time, i) => {
  const d = [0.1, -0.2, 0.003, 0.004, 0.5], k = [52, 0, 7.5, 0, 53, 5.5, 0, 0, 1];
  const r = [1, 0, 0, 0, 1, 0, 0, 0, 1], p = [50, 0, 7, 0, 0, 51, 5, 0, 0, 0, 1, 0];
  return { header: head(version, time, "camera", i), height, width, distortion_model: "plumb_bob",
    binning_x: 0, binning_y: 0, roi: { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false },
    ...(version === 1 ? { D: d, K: k, R: r, P: p } : { d, k, r, p }) };
};
const serialise = (version, type, message) =>
  new (version === 1 ? ros1 : ros2).MessageWriter(parse(definition(version, type), { ros2: version === 2 })).writeMessage(message);

// All messages of a recording: topic, type, time and bytes, in the order in which they are received.
const base = "/camera/camera/";
function messages(version, kind = "raw") {
  const list = [];
  for (let i = 0; i < frames; ++i) {
    list.push([base + "color/camera_info", "CameraInfo", colourTime(i), serialise(version, "CameraInfo", cameraInfo(version, colourTime(i), i))]);
    if (kind === "raw") {
      list.push([base + "color/image_raw", "Image", colourTime(i), serialise(version, "Image", image(version, colourTime(i), i, "bgr8", 3, colourBytes(i)))]);
      list.push([base + "aligned_depth_to_color/image_raw", "Image", depthTime(i), serialise(version, "Image", image(version, depthTime(i), i, "16UC1", 2, depthBytes(i)))]);
    } else {
      list.push([base + "color/image_raw/compressed", "CompressedImage", colourTime(i), serialise(version, "CompressedImage", compressed(version, colourTime(i), i, "rgb8; png compressed bgr8", colourPng(i)))]);
      list.push([base + "aligned_depth_to_color/image_raw/compressedDepth", "CompressedImage", depthTime(i),
        serialise(version, "CompressedImage", compressed(version, depthTime(i), i, "16UC1; compressedDepth png", Buffer.concat([Buffer.alloc(12), depthPng(i)])))]);
    }
  }
  return list;
}
// Big-endian CDR, field by field.
function bigEndianMessages() {
  return messages(2).map(([topic, type, time, bytes]) => {
    const message = new ros2.MessageReader(parse(definition(2, type), { ros2: true })).readMessage(bytes);
    const writer = new CdrWriter({ kind: EncapsulationKind.CDR_BE });
    writer.int32(message.header.stamp.sec).uint32(message.header.stamp.nanosec ?? message.header.stamp.nsec).string(message.header.frame_id);
    writer.uint32(message.height).uint32(message.width);
    if (type === "Image") {
      writer.string(message.encoding).uint8(message.is_bigendian).uint32(message.step).uint8Array(message.data, true);
    } else {
      writer.string(message.distortion_model).float64Array(Array.from(message.d), true);
      for (const list of [message.k, message.r, message.p]) writer.float64Array(Array.from(list));
      writer.uint32(0).uint32(0).uint32(0).uint32(0).uint32(0).uint32(0).uint8(0);
    }
    return [topic, type, time, writer.data];
  });
}

class MemoryFile {
  parts = [];
  size = 0n;
  async write(bytes) { this.parts.push(Buffer.from(bytes)); this.size += BigInt(bytes.length); }
  position() { return this.size; }
}
async function writeMcap(name, version, list, options) {
  const file = new MemoryFile();
  const writer = new McapWriter({ writable: file, chunkSize: 3000, ...options });
  await writer.start({ profile: `ros${version}`, library: "write_bags.mjs" });
  const channels = new Map();
  const json = await writer.registerChannel({ topic: "/status", messageEncoding: "json", schemaId: 0, metadata: new Map() });
  let sequence = 0;
  for (const [topic, type, time, bytes] of list) {
    if (!channels.has(topic)) {
      const schemaId = await writer.registerSchema({ name: version === 1 ? `sensor_msgs/${type}` : `sensor_msgs/msg/${type}`,
        encoding: `ros${version}msg`, data: new TextEncoder().encode(definition(version, type)) });
      channels.set(topic, await writer.registerChannel({ topic, messageEncoding: version === 1 ? "ros1" : "cdr", schemaId, metadata: new Map() }));
    }
    await writer.addMessage({ channelId: channels.get(topic), sequence: sequence++, publishTime: nanoseconds(time), logTime: nanoseconds(time), data: bytes });
    await writer.addMessage({ channelId: json, sequence: sequence++, publishTime: nanoseconds(time), logTime: nanoseconds(time), data: Buffer.from("{}") });
  }
  await writer.addMetadata({ name: "rosbag2", metadata: new Map([["serialized_metadata", ""]]) });
  await writer.addAttachment({ logTime: 0n, createTime: 0n, name: "note.txt", mediaType: "text/plain", data: Buffer.from("a note") });
  await writer.end();
  fs.writeFileSync(path.join(folder, name), Buffer.concat(file.parts));
}
const byZstd = { compressChunk: (data) => ({ compression: "zstd", compressedData: zstd.compress(data, 9) }) };
const byLz4 = { compressChunk: (data) => ({ compression: "lz4", compressedData: lz4.compress(data) }) };
const bare = { useStatistics: false, useSummaryOffsets: false, repeatSchemas: false, repeatChannels: false, useAttachmentIndex: false,
  useMetadataIndex: false, useMessageIndex: false, useChunkIndex: false };

// The tables of rosbag2, in the versions of Foxy and Jazzy (schema 2 and 4).
function database(list, schema, pageSize = 1024) {
  const data = new SQL.Database();
  data.run(`PRAGMA page_size = ${pageSize}`);
  const hash = schema >= 4 ? ", type_description_hash TEXT NOT NULL" : "";
  if (schema >= 3) data.run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)");
  if (schema >= 3) data.run("INSERT INTO schema VALUES (?, 'jazzy')", [schema]);
  if (schema >= 3) data.run("CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL)");
  data.run(`CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL${hash})`);
  data.run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL)");
  data.run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  const topics = new Map();
  for (const [topic, type, time, bytes] of list) {
    if (!topics.has(topic)) {
      topics.set(topic, topics.size + 1);
      data.run(`INSERT INTO topics VALUES (?, ?, ?, 'cdr', ''${hash ? ", ''" : ""})`, [topics.get(topic), topic, `sensor_msgs/msg/${type}`]);
    }
    data.run("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", [topics.get(topic), nanoseconds(time).toString(), bytes]);
  }
  return Buffer.from(data.export());
}
function rosbag2(name, files, compression) {
  fs.mkdirSync(path.join(folder, name), { recursive: true });
  for (const [file, bytes] of files) fs.writeFileSync(path.join(folder, name, file), bytes);
  const list = files.map(([file]) => `    - ${file}\n`).join("");
  fs.writeFileSync(path.join(folder, name, "metadata.yaml"), `rosbag2_bagfile_information:
  version: 4
  storage_identifier: sqlite3
  relative_file_paths:
${list}  duration:
    nanoseconds: 101000000
  starting_time:
    nanoseconds_since_epoch: 1700000000905000000
  message_count: ${3 * frames}
  topics_with_message_count: []
  compression_format: "${compression ? "zstd" : ""}"
  compression_mode: "${compression}"
`);
}
async function writeFew() {
  await writeMcap("zstd.mcap", 2, messages(2), byZstd);
  await writeMcap("lz4.mcap", 2, messages(2), byLz4);
  await writeMcap("chunks.mcap", 2, messages(2), {});
  await writeMcap("without_chunks.mcap", 2, messages(2), { useChunks: false });
  await writeMcap("without_index.mcap", 2, messages(2), { ...byZstd, ...bare });
  await writeMcap("ros1.mcap", 1, messages(1), byLz4);
  await writeMcap("compressed_images.mcap", 2, messages(2, "compressed"), byZstd);
  await writeMcap("big_endian.mcap", 2, bigEndianMessages(), byZstd);
  const all = messages(2);
  fs.writeFileSync(path.join(folder, "jazzy.db3"), database(all, 4));
  rosbag2("split", [["split_0.db3", database(all.slice(0, 5), 2)], ["split_1.db3", database(all.slice(5), 2)]], "");
  rosbag2("zstd_files", [["zstd_files_0.db3.zstd", zstd.compress(database(all.slice(0, 7), 4), 9)], ["zstd_files_1.db3.zstd", zstd.compress(database(all.slice(7), 4), 9)]], "FILE");
  rosbag2("zstd_messages", [["zstd_messages_0.db3", database(all.map(([topic, type, time, bytes]) => [topic, type, time, zstd.compress(bytes, 9)]), 2)]], "MESSAGE");
}

async function writeMany() {
  const lists = { raw: [2, messages(2)], compressed: [2, messages(2, "compressed")], big_endian: [2, bigEndianMessages()], ros1: [1, messages(1)] };
  const ways = { plain: {}, lz4: byLz4, zstd: byZstd };
  for (const [kind, [version, list]] of Object.entries(lists))
    for (const [index, options] of Object.entries({ indexed: {}, bare })) {
      await writeMcap(`${kind}_without_chunks_${index}.mcap`, version, list, { useChunks: false, ...options });
      for (const [way, compression] of Object.entries(ways))
        for (const chunkSize of [1, 2000, 1000000])
          await writeMcap(`${kind}_${way}_${chunkSize}_${index}.mcap`, version, list, { ...compression, ...options, chunkSize });
    }
  for (const kind of ["raw", "compressed", "big_endian"])
    for (const schema of [2, 3, 4])
      for (const pageSize of [512, 4096, 65536])
        fs.writeFileSync(path.join(folder, `${kind}_${schema}_${pageSize}.db3`), database(lists[kind][1], schema, pageSize));
}

await (process.argv[3] === "many" ? writeMany() : writeFew());
