"""Logs of autopilots and bags of ROS, read by the packages of their own projects."""
