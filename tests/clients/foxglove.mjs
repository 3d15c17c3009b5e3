// What a client of Foxglove's protocol sees: channels, three samples, a message of each other channel, and that
// parameters cannot be set. One JSON line.
import protocol from "@foxglove/ws-protocol";
import { WebSocket } from "ws";

const { FoxgloveClient } = protocol;
const SUBPROTOCOL = "foxglove.sdk.v1"; // what servers of the SDK speak; the package has its former name
FoxgloveClient.SUPPORTED_SUBPROTOCOL = SUBPROTOCOL;
const client = new FoxgloveClient({ ws: new WebSocket(process.argv[2], [SUBPROTOCOL]) });
const said = { channels: {}, messages: {}, parameters: [] };
const topics = new Map();
const isEnough = () => Object.keys(said.messages).length === 3 && said.messages["/gyro/sample"].length >= 3
  && said.parameters.length === 2;

client.on("error", (error) => { console.error(error); process.exit(1); });
client.on("serverInfo", (event) => { said.capabilities = event.capabilities; });
client.on("parameterValues", ({ id, parameters }) => {
  said.parameters.push(parameters);
  if (id !== "get") return;
  const others = parameters.map((each) => ({ ...each, value: typeof each.value === "string" ? "other" : each.value + 1 }));
  client.setParameters(others, "set");
});
client.on("advertise", (channels) => {
  for (const channel of channels) {
    said.channels[channel.topic] = { ...channel, schema: JSON.parse(channel.schema) };
    topics.set(client.subscribe(channel.id), channel.topic);
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const message = { timestamp: String(timestamp), ...JSON.parse(new TextDecoder().decode(data)) };
  const messages = (said.messages[topics.get(subscriptionId)] ??= []);
  if (messages.push(message) === 1 && topics.get(subscriptionId) === "/gyro/state") client.getParameters([], "get");
  if (isEnough()) {
    console.log(JSON.stringify(said));
    process.exit(0);
  }
});
