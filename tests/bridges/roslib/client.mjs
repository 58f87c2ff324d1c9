// A client with the real roslib in a process of its own: node client.mjs PORT
import * as ROSLIB from "roslib";

const ros = new ROSLIB.Ros({ url: `ws://127.0.0.1:${process.argv[2]}` });
const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
const call = (name, request) =>
  new Promise((done, fail) => new ROSLIB.Service({ ros, name, serviceType: "any/Type" }).callService(request, done, fail));
await new Promise((done) => ros.on("connection", done));
const found = {};
found.topics = (await new Promise((done, fail) => ros.getTopics(done, fail))).topics;
found.details = (await new Promise((done, fail) => ros.getMessageDetails("geometry_msgs/Twist", done, fail))).map((one) => one.type);
found.scans = {};
for (const compression of ["none", "png", "cbor", "cbor-raw"]) {
  const topic = new ROSLIB.Topic({ ros, name: "/robot/scan", messageType: "sensor_msgs/msg/LaserScan", compression });
  let count = 0; // the first ones may be on their way from the subscription before
  const message = await new Promise((done) => topic.subscribe((one) => ++count === 5 && done(one)));
  topic.unsubscribe();
  found.scans[compression] = message.ranges ? [message.ranges.constructor.name, message.ranges.length] : Object.keys(message);
}
const command = new ROSLIB.Topic({ ros, name: "/robot/cmd_vel", messageType: "geometry_msgs/msg/Twist" });
for (let k = 0; k < 20; k++) {
  command.publish({ linear: { x: 0.4, y: 0, z: 0 }, angular: { x: 0, y: 0, z: 0 } });
  await pause(50);
}
found.x = (await call("/crowdbot/get_entity_state", { entity: "robot" })).state.pose.position.x;
const service = new ROSLIB.Service({ ros, name: "/add", serviceType: "example/Add" });
service.advertise((request, response) => {
  response.sum = request.a + request.b;
  return true;
});
await pause(200);
found.sum = (await call("/add", { a: 2, b: 3 })).sum;
await call("/crowdbot/set_simulation_state", { state: { state: 2 } });
const name = "/crowdbot/simulate_steps";
const action = new ROSLIB.Action({ ros, name, actionType: "simulation_interfaces/action/SimulateSteps" });
found.feedback = 0;
found.result = await new Promise((done, fail) => action.sendGoal({ steps: 40 }, done, () => found.feedback++, fail));
console.log(JSON.stringify(found));
ros.close();
