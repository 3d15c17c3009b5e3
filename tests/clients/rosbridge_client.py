"""Program with roslibpy: prints topics, their type, and three Imu messages as one JSON line."""

import json
import sys
import threading

import roslibpy

PATIENCE_S = 240

host, port, throttle_ms = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
ros = roslibpy.Ros(host, port)
ros.run(timeout=PATIENCE_S)
enough = threading.Event()
messages: list[dict[str, object]] = []


def take(message: dict[str, object]) -> None:
    messages.append(message)
    if len(messages) == 3:
        enough.set()


topics = {topic: ros.get_topic_type(topic) for topic in ros.get_topics()}
imu = roslibpy.Topic(ros, "/imu/data", "sensor_msgs/Imu", throttle_rate=throttle_ms)
imu.subscribe(take)
assert enough.wait(PATIENCE_S), messages
imu.unsubscribe()
time = ros.get_time()
try:
    ros.get_param("/gyro/rate")
    refused = ""
except roslibpy.core.ServiceException as error:
    refused = str(error)
print(json.dumps({"topics": topics, "messages": messages[:3], "time_s": time.to_sec(), "refused": refused}))
ros.terminate()
