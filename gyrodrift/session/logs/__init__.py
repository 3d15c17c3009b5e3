"""Logs of autopilots and bags of ROS, through the packages of their own projects."""
