"""Reference angles on another topic of a recording than its samples: odometry, poses and joints of ROS."""
