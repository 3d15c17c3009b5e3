"""Effects of a real gyro, its environment, its encoder and its link on an ideal measurement, by stage."""
