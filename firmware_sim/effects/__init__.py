"""What a real gyro, its surroundings and its link add to an ideal measurement, in rooms by stage."""
