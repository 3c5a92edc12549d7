// SPDX-License-Identifier: BSD-3-Clause
// Foxglove's own client (npm: @foxglove/ws-protocol) on a live connection: node listen_foxglove.mjs ADDRESS PROTOCOL, in
// the folder of node_modules. Subscribes to all topics, and when the server closes prints, as JSON, what it got: the code of the end, the information, the channels, the status messages, and for each topic the number of
// messages, their first and last time, and the last message.
import { createRequire } from "node:module";
import path from "node:path";

const require = createRequire(path.join(process.cwd(), "package.json"));
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");

const [address, protocol] = process.argv.slice(2);
const socket = new WebSocket(address, [protocol]);
const client = new FoxgloveClient({ ws: socket });
const found = { statuses: [], topics: {} };
const topicOf = new Map();
client.on("error", (error) => {
  console.log(JSON.stringify({ error: String(error) }));
  process.exit(1);
});
client.on("serverInfo", (information) => {
  found.information = information;
  found.protocol = socket.protocol;
});
client.on("status", (status) => found.statuses.push(status.message));
client.on("advertise", (channels) => {
  found.channels = channels.map(({ topic, encoding, schemaName, schemaEncoding, schema }) => ({
    topic, encoding, schemaName, schemaEncoding, title: JSON.parse(schema).title }));
  for (const { id, topic } of channels) topicOf.set(client.subscribe(id), topic);
  client.unsubscribe(999); // what a client should not do is answered
  client.subscribe(12345);
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const topic = (found.topics[topicOf.get(subscriptionId)] ??= { count: 0, first: String(timestamp) });
  topic.count++;
  topic.time = String(timestamp);
  topic.last = JSON.parse(new TextDecoder().decode(data));
});
client.on("close", (event) => {
  found.end = event.code;
  console.log(JSON.stringify(found));
  process.exit(0);
});
