// What a page with roslib sees: the topics, three Imu messages, and a service that is not there. One JSON line.
import * as ROSLIB from "roslib";

const ros = new ROSLIB.Ros({ url: process.argv[2] });
const told = (ask) => new Promise((done) => ask((values) => done({ values }), (error) => done({ error: String(error) })));

ros.on("error", (error) => { console.error(error); process.exit(1); });
ros.on("connection", async () => {
  const topics = await told((ok, failed) => ros.getTopics(ok, failed));
  const nodes = await told((ok, failed) => ros.getNodes(ok, failed));
  const away = new ROSLIB.Service({ ros, name: "/gyro/zero", serviceType: "std_srvs/Empty" });
  const refused = await told((ok, failed) => away.callService({}, ok, failed));
  const status = new Promise((done) => ros.on("status", done));
  ros.callOnConnection({ op: "publish", topic: "/imu/data", msg: {} }); // without an id, whose status goes to "status"
  const imu = new ROSLIB.Topic({ ros, name: "/imu/data", messageType: "sensor_msgs/Imu", throttle_rate: 25 });
  const messages = [];
  const warned = await status;
  imu.subscribe((message) => {
    messages.push(message);
    if (messages.length === 3) {
      imu.unsubscribe();
      console.log(JSON.stringify({ topics, nodes, refused, warned, messages }));
      ros.close();
      process.exit(0);
    }
  });
});
