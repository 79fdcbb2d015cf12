"""A node of ROS 2 that says hello once a second, and prints what nodes on other robots say.

`RMW_IMPLEMENTATION=rmw_zenoh_cpp python3 hello_ros2.py ROBOT`, on a robot that runs Sendworthy and no rmw_zenohd. The
node knows nothing of Sendworthy: the daemon is where rmw_zenoh looks for its router.
"""

import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Hello(Node):
    """Talks and listens on /chatter."""

    def __init__(self, robot: str) -> None:
        super().__init__("hello", namespace=robot)
        self._robot = robot
        self._publisher = self.create_publisher(String, "/chatter", 10)
        self.create_subscription(String, "/chatter", self._hear, 10)
        self.create_timer(1.0, self._say)

    def _say(self) -> None:
        self._publisher.publish(String(data=f"hello from {self._robot}"))

    def _hear(self, message: String) -> None:
        if not message.data.endswith(f" {self._robot}"):
            self.get_logger().info(message.data)


rclpy.init()
rclpy.spin(Hello(sys.argv[1]))
