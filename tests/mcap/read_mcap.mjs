// SPDX-License-Identifier: BSD-3-Clause
// Reads an MCAP file by its index with libraries of others, decodes every message, and checks those of Foxglove against
// Foxglove's own schemas: node read_mcap.mjs FILE, in the folder of node_modules. Prints, as JSON, the profile, the
// compressions of the chunks, and for each topic the type, the number of messages, and the last one.
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const require = createRequire(path.join(process.cwd(), "package.json"));
const { McapIndexedReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const foxglove = require("@foxglove/schemas/jsonschema");
const zstd = require("@foxglove/wasm-zstd");
const Ajv = require("ajv");
await zstd.isLoaded;

const file = fs.readFileSync(process.argv[2]);
const readable = {
  size: async () => BigInt(file.length),
  read: async (offset, size) => file.subarray(Number(offset), Number(offset + size)),
};
const reader = await McapIndexedReader.Initialize({
  readable,
  decompressHandlers: { zstd: (bytes, size) => zstd.decompress(bytes, Number(size)) },
});

// Foxglove's schemas have no names of ajv's formats, and its integers are JSON's.
const ajv = new Ajv({ strict: false, formats: {} });
function decoderOf(channel) {
  const schema = reader.schemasById.get(channel.schemaId);
  const text = new TextDecoder().decode(schema.data);
  if (channel.messageEncoding === "cdr") {
    const messages = new MessageReader(parse(text, { ros2: true }));
    return (bytes) => messages.readMessage(bytes);
  }
  const own = ajv.compile(JSON.parse(text));
  const published = schema.name.startsWith("foxglove.") ? ajv.compile(Object.values(foxglove).find((s) => s.title === schema.name)) : own;
  return (bytes) => {
    const message = JSON.parse(new TextDecoder().decode(bytes));
    for (const validate of [own, published])
      if (!validate(message)) throw new Error(`${channel.topic}: ${ajv.errorsText(validate.errors)}`);
    for (const name of Object.keys(published.schema.properties ?? {}))
      if (!(name in message)) throw new Error(`${channel.topic}: lacks ${name} of ${schema.name}`);
    return message;
  };
}

const topics = {};
const decoders = new Map();
for await (const { channelId, data, logTime } of reader.readMessages()) {
  const channel = reader.channelsById.get(channelId);
  if (!decoders.has(channelId)) decoders.set(channelId, decoderOf(channel));
  const topic = (topics[channel.topic] ??= { type: reader.schemasById.get(channel.schemaId).name, count: 0 });
  topic.count++;
  topic.time = String(logTime);
  topic.last = decoders.get(channelId)(data);
}
const plain = (key, value) => (typeof value === "bigint" ? String(value) : ArrayBuffer.isView(value) ? Array.from(value) : value);
const compressions = [...new Set(reader.chunkIndexes.map((chunk) => chunk.compression))];
console.log(JSON.stringify({ profile: reader.header.profile, compressions, statistics: reader.statistics?.messageCount, topics }, plain));
